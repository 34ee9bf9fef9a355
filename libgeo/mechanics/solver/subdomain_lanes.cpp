// Stiffness tiles Σ w (μ (g_a · g_b) 1 + μ g_b g_aᵀ + λ g_a g_bᵀ) of eight subdomains, inverted by
// the sweep operator, one subdomain per lane. Compiled for each instruction set
// (base/simd_targets.h).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/solver/subdomain_lanes.cpp"
#include "base/simd_targets.h"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <algorithm>

#include "hwy/highway.h"
#include "mechanics/material/matrix_lanes.h"
#include "mechanics/solver/subdomain_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A node of a subdomain that a point sees: its slot, and its shape gradient.
struct SeenNode {
  std::uint32_t slot;
  const float* g;
};

// Adds w g_a g_bᵀ for the nodes that one point sees, which ascend.
HWY_INLINE void add_point(float w, std::span<const SeenNode> seen, float* tiles) {
  using Four = hn::CappedTag<float, 4>;
  const Four d;
  constexpr std::size_t step = hn::MaxLanes(Four());
  for (std::size_t a = 0; a < seen.size(); ++a) {
    const auto x = hn::Set(d, w * seen[a].g[0]), y = hn::Set(d, w * seen[a].g[1]), z = hn::Set(d, w * seen[a].g[2]);
    const std::size_t s = seen[a].slot;
    float* const row = tiles + 12 * (s * (s + 1) / 2);
    for (std::size_t b = 0; b <= a; ++b) {
      float* const to = row + 12 * std::size_t(seen[b].slot);
      for (std::size_t k = 0; k < 4; k += step) {
        const auto g = hn::LoadU(d, seen[b].g + k);
        hn::StoreU(hn::MulAdd(x, g, hn::LoadU(d, to + k)), d, to + k);
        hn::StoreU(hn::MulAdd(y, g, hn::LoadU(d, to + 4 + k)), d, to + 4 + k);
        hn::StoreU(hn::MulAdd(z, g, hn::LoadU(d, to + 8 + k)), d, to + 8 + k);
      }
    }
  }
}

void OuterProducts(const PointBlock& block, const std::uint32_t* first, const Subdomains::Incidence* places,
                   BlockOuterProducts& out) {
  // Per subdomain: the nodes that the present point sees, in the space of all its nodes.
  std::vector<std::uint32_t> begin(out.subdomains.size() + 1, 0), count(out.subdomains.size(), 0);
  for (std::uint32_t k = 0; k < first[block.nodes.size()]; ++k) ++begin[places[k].subdomain + 1];
  for (std::size_t p = 0; p < count.size(); ++p) begin[p + 1] += begin[p];
  std::vector<SeenNode> seen(begin.back());
  std::vector<std::uint8_t> belongs(block.nodes.size());
  for (std::size_t k = 0; k < belongs.size(); ++k) belongs[k] = first[k] < first[k + 1];
  std::vector<std::uint32_t> touched, entries;
  for (std::uint32_t i = 0; i < block.points.size(); ++i) {
    const MaterialPoint& point = block.points[i];
    if (point.quality == MomentQuality::singular) continue;
    const auto from = block.entry_begin[i], to = block.entry_begin[i + 1];
    entries.resize(to - from);
    std::size_t used = 0;  // few entries, in no order that a processor predicts: no branch
    for (auto q = from; q < to; ++q) {
      entries[used] = q;
      used += belongs[block.entry_node[q]];
    }
    for (std::size_t e = 0; e < used; ++e) {
      const auto node = block.entry_node[entries[e]];
      const float* const g = &block.entry_gradient_single[3 * std::size_t(entries[e])];
      for (auto k = first[node]; k < first[node + 1]; ++k) {
        const auto p = places[k].subdomain;
        if (count[p] == 0) touched.push_back(p);
        seen[begin[p] + count[p]++] = {places[k].slot, g};
      }
    }
    for (const auto p : touched) {
      add_point(static_cast<float>(point.unscaled_volume), {&seen[begin[p]], count[p]}, &out.outer[out.first[p]]);
      if (count[p] > out.best_point[p].nodes) out.best_point[p] = {count[p], i};
      count[p] = 0;
    }
    touched.clear();
  }
}

using Wide = hn::CappedTag<float, 16>;
constexpr std::size_t wide = hn::MaxLanes(Wide());

using Vector = V<float>;
struct Tile {
  Vector at[3][3];  // [row][column]
};
HWY_INLINE Tile load_tile(const float* from) {
  Tile t;
  for (std::size_t k = 0; k < 9; ++k) t.at[k / 3][k % 3] = hn::LoadU(Lanes<float>(), from + 8 * k);
  return t;
}
HWY_INLINE void store_tile(const Tile& t, float* to) {
  for (std::size_t k = 0; k < 9; ++k) hn::StoreU(t.at[k / 3][k % 3], Lanes<float>(), to + 8 * k);
}
HWY_INLINE Tile transposed(const Tile& t) {
  Tile out;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) out.at[r][c] = t.at[c][r];
  return out;
}
/// a · b
HWY_INLINE Tile product(const Tile& a, const Tile& b) {
  Tile out;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      out.at[r][c] =
          hn::MulAdd(a.at[r][2], b.at[2][c], hn::MulAdd(a.at[r][1], b.at[1][c], hn::Mul(a.at[r][0], b.at[0][c])));
  return out;
}
/// from −= a · bᵀ
HWY_INLINE void subtract_product(const Tile& a, const Tile& b, Tile& from) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) from.at[r][c] = hn::NegMulAdd(a.at[r][k], b.at[c][k], from.at[r][c]);
}
constexpr std::size_t tile_at(std::size_t a, std::size_t b) { return 72 * (a * (a + 1) / 2 + b); }

// Replaces Σ w g_a g_bᵀ by the stiffness of an isotropic material, Σ w (μ (g_a · g_b) 1 + μ g_b
// g_aᵀ + λ g_a g_bᵀ), and adds the diagonal blocks, rotated back.
HWY_INLINE void assemble_stiffness(EightSubdomains& p, std::size_t lane) {
  const Lanes<float> d;
  const auto shear = hn::LoadU(d, &p.shear[lane]), bulk = hn::LoadU(d, &p.bulk[lane]);
  const Tile back = load_tile(&p.turn[lane]), turn = transposed(back);
  for (std::size_t a = 0; a < p.nodes; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      float* const to = &p.tiles[tile_at(a, b) + lane];
      const Tile outer = load_tile(to);
      const auto even = hn::Mul(shear, hn::Add(hn::Add(outer.at[0][0], outer.at[1][1]), outer.at[2][2]));
      Tile k;
      if (a == b) k = product(product(back, load_tile(&p.blocks[72 * a + lane])), turn);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
          auto sum = hn::MulAdd(bulk, outer.at[r][c], hn::Mul(shear, outer.at[c][r]));
          if (r == c) sum = hn::Add(sum, even);
          k.at[r][c] = a == b ? hn::Add(sum, k.at[r][c]) : sum;
        }
      store_tile(k, to);
    }
}

// The inverse of a symmetric tile by the sweep operator, pivot by pivot; pivots not above `least`
// are left out.
HWY_INLINE Tile inverse(Tile t, const Vector (&least)[3]) {
  const auto one = hn::Set(Lanes<float>(), 1.0f);
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const auto over = hn::IfThenElseZero(hn::Gt(t.at[k][k], least[k]), hn::Div(one, t.at[k][k])), by = t.at[i][k],
               next = t.at[j][k];
    const auto own = hn::Mul(by, over), other = hn::Mul(next, over);
    t.at[i][i] = hn::NegMulAdd(by, own, t.at[i][i]);
    t.at[j][j] = hn::NegMulAdd(next, other, t.at[j][j]);
    t.at[i][j] = t.at[j][i] = hn::NegMulAdd(by, other, t.at[i][j]);
    t.at[i][k] = t.at[k][i] = own;
    t.at[j][k] = t.at[k][j] = other;
    t.at[k][k] = hn::Neg(over);
  }
  for (auto& row : t.at)
    for (auto& x : row) x = hn::Neg(x);
  return t;
}

// The sweep operator, node by node: swept rows and columns hold −K⁻¹ of the swept nodes, all others
// their Schur complement. The matrix stays symmetric, so half of the tiles suffice.
HWY_INLINE void sweep(EightSubdomains& p, std::size_t lane) {
  const Lanes<float> d;
  const auto rounding = hn::Set(d, 1e-5f);  // of a diagonal entry: a smaller pivot is error of single precision
  float *const tiles = p.tiles.data() + lane, *const column = p.scratch.data() + lane,
               *const diagonal = p.diagonal.data() + lane;
  for (std::size_t a = 0; a < p.nodes; ++a)
    for (std::size_t c = 0; c < 3; ++c)
      hn::StoreU(hn::LoadU(d, tiles + tile_at(a, a) + 32 * c), d, diagonal + 8 * (3 * a + c));
  for (std::size_t k = 0; k < p.nodes; ++k) {
    Vector pivot_bound[3];
    for (std::size_t c = 0; c < 3; ++c) pivot_bound[c] = hn::Mul(rounding, hn::LoadU(d, diagonal + 24 * k + 8 * c));
    Tile own = inverse(load_tile(tiles + tile_at(k, k)), pivot_bound);
    for (std::size_t a = 0; a < p.nodes; ++a) {
      if (a == k) continue;
      const Tile of_k = a > k ? load_tile(tiles + tile_at(a, k)) : transposed(load_tile(tiles + tile_at(k, a)));
      store_tile(of_k, column + 72 * a);
      const Tile by = product(of_k, own);
      for (std::size_t b = 0; b <= a; ++b) {
        if (b == k) continue;
        Tile rest = load_tile(tiles + tile_at(a, b));
        subtract_product(by, load_tile(column + 72 * b), rest);
        store_tile(rest, tiles + tile_at(a, b));
      }
      if (a > k)
        store_tile(by, tiles + tile_at(a, k));
      else
        store_tile(transposed(by), tiles + tile_at(k, a));
    }
    for (auto& row : own.at)
      for (auto& x : row) x = hn::Neg(x);
    store_tile(own, tiles + tile_at(k, k));
  }
}

void InvertPositive(EightSubdomains& p) {
  const Lanes<float> d;
  const hn::RebindToUnsigned<Lanes<float>> d32;
  const hn::Rebind<std::uint16_t, Lanes<float>> d16;
  for (std::size_t lane = 0; lane < 8; lane += width<float>) {
    assemble_stiffness(p, lane);
    sweep(p, lane);
    for (std::size_t a = 0; a < p.nodes; ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        const auto share = hn::Neg(hn::Mul(hn::LoadU(d, &p.share[8 * a + lane]), hn::LoadU(d, &p.share[8 * b + lane])));
        for (std::size_t at = tile_at(a, b) + lane, k = 0; k < 9; ++k, at += 8) {
          const auto bits = hn::BitCast(d32, hn::Mul(share, hn::LoadU(d, &p.tiles[at])));
          hn::StoreU(hn::TruncateTo(d16, hn::ShiftRight<16>(hn::Add(bits, hn::Set(d32, 0x8000u)))), d16, &p.halves[at]);
        }
      }
  }
}

// Numbers of a matrix from `at` on, as floats.
HWY_INLINE hn::Vec<Wide> load_numbers(const std::uint16_t* at) {
  const Wide d;
  const hn::Rebind<std::uint16_t, Wide> d16;
  const hn::RebindToUnsigned<Wide> d32;
  return hn::BitCast(d, hn::ShiftLeft<16>(hn::PromoteTo(d32, hn::LoadU(d16, at))));
}
HWY_INLINE hn::Vec<Wide> load_numbers(const float* at) { return hn::LoadU(Wide(), at); }

// The matrix is symmetric, so its rows are read as columns: no sum across a vector.
template <class Number>
HWY_INLINE void multiply(std::size_t size, const Number* matrix, const float* x, float* out) {
  const Wide d;
  const std::size_t row = padded(size);
  std::size_t at = 0;
  for (; at + 2 * wide <= row; at += 2 * wide) {
    auto sum = hn::Zero(d), next = hn::Zero(d);
    for (std::size_t j = 0; j < size; ++j) {
      const auto by = hn::Set(d, x[j]);
      sum = hn::MulAdd(by, load_numbers(matrix + j * row + at), sum);
      next = hn::MulAdd(by, load_numbers(matrix + j * row + at + wide), next);
    }
    hn::StoreU(sum, d, out + at);
    hn::StoreU(next, d, out + at + wide);
  }
  for (; at < row; at += wide) {
    auto sum = hn::Zero(d);
    for (std::size_t j = 0; j < size; ++j) sum = hn::MulAdd(hn::Set(d, x[j]), load_numbers(matrix + j * row + at), sum);
    hn::StoreU(sum, d, out + at);
  }
}

void MultiplyHalves(std::size_t size, const std::uint16_t* matrix, const float* x, float* out) {
  multiply(size, matrix, x, out);
}
void MultiplyFloats(std::size_t size, const float* matrix, const float* x, float* out) {
  multiply(size, matrix, x, out);
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(OuterProducts);
HWY_EXPORT(InvertPositive);
HWY_EXPORT(MultiplyHalves);
HWY_EXPORT(MultiplyFloats);

void add_outer_products(const PointBlock& block, std::span<const std::uint32_t> first,
                        std::span<const Subdomains::Incidence> places, BlockOuterProducts& out) {
  HWY_DYNAMIC_DISPATCH(OuterProducts)(block, first.data(), places.data(), out);
}
void EightSubdomains::begin(std::size_t count) {
  nodes = count;
  tiles.assign(72 * (count * (count + 1) / 2), 0);
  blocks.assign(72 * count, 0);
  share.assign(8 * count, 0);
  turn.fill(0);
  shear.fill(0);
  bulk.fill(0);
  halves.resize(tiles.size());
  diagonal.resize(24 * count);
  scratch.resize(72 * count);
}
void invert_positive(EightSubdomains& subdomains) { HWY_DYNAMIC_DISPATCH(InvertPositive)(subdomains); }
void multiply_halves(std::size_t size, const std::uint16_t* matrix, const float* x, float* out) {
  HWY_DYNAMIC_DISPATCH(MultiplyHalves)(size, matrix, x, out);
}
void multiply_floats(std::size_t size, const float* matrix, const float* x, float* out) {
  HWY_DYNAMIC_DISPATCH(MultiplyFloats)(size, matrix, x, out);
}

}  // namespace geo
#endif
