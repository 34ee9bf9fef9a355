// Compiled for each instruction set (base/simd_targets.h). MulAdd fuses products and sums where the
// processor can, because arithmetic limits the speed of a stiffness product. All targets that fuse
// give the same bits.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/discretisation/stiffness_product_lanes.cpp"
#include "base/simd_targets.h"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <algorithm>

#include "hwy/highway.h"
#include "mechanics/discretisation/stiffness_product_lanes.h"
#include "mechanics/material/matrix_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {

// Points per pass through the three steps, so that intermediate matrices stay in the cache. Layout
// of a batch: entry 3 c + r (column c, row r) of all points, then the next entry.
constexpr std::size_t batch = 32;

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void quad_gradients(const PointBlock& block, std::size_t quad, const float* HWY_RESTRICT values,
                               float* HWY_RESTRICT out) {
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t r = 0; r < 3; ++r) {
        float sums[2] = {0, 0};
        for (std::size_t k = block.quad_begin[quad]; k < block.quad_begin[quad + 1]; ++k)
          sums[k % 2] += values[4 * std::size_t(block.quad_node[k]) + r] *
                         float(block.quad_gradient[12 * (k - k % 2) + 8 * c + 4 * (k % 2) + i]);
        out[batch * (3 * c + r) + i] = sums[0] + sums[1];
      }
}
HWY_INLINE void quad_divergence(const PointBlock& block, std::size_t quad, const float* HWY_RESTRICT stress,
                                float* HWY_RESTRICT out) {
  for (std::size_t k = block.quad_begin[quad]; k < block.quad_begin[quad + 1]; ++k)
    for (std::size_t r = 0; r < 3; ++r) {
      const auto force_of_point = [&](std::size_t i) {
        const auto term = [&](std::size_t c) {
          return stress[batch * (3 * c + r) + i] *
                 float(block.quad_gradient[12 * (k - k % 2) + 8 * c + 4 * (k % 2) + i]);
        };
        return term(0) + term(1) + term(2);
      };
      out[4 * std::size_t(block.quad_node[k]) + r] +=
          (force_of_point(0) + force_of_point(2)) + (force_of_point(1) + force_of_point(3));
    }
}
#else
// A vector holds four points for one node, or for two nodes side by side. Two sums take the nodes
// alternately at any vector width, so that all widths add in the same order.
using Eight = hn::CappedTag<float, 8>;
using Four = hn::CappedTag<float, 4>;

// The quantised gradients of four points per node, one coordinate.
template <class Wide>
HWY_INLINE hn::Vec<Wide> load_gradient(const std::int16_t* HWY_RESTRICT at) {
  return hn::ConvertTo(
      Wide(), hn::PromoteTo(hn::Rebind<std::int32_t, Wide>(), hn::LoadU(hn::Rebind<std::int16_t, Wide>(), at)));
}

// Adds u gᵀ of a node, or of two, to the gradients `sum` of four points.
template <class Wide>
HWY_INLINE void add_node(hn::Vec<Wide> u, const std::int16_t* HWY_RESTRICT at, hn::Vec<Wide>* HWY_RESTRICT sum) {
  const hn::Vec<Wide> component[3] = {hn::Broadcast<0>(u), hn::Broadcast<1>(u), hn::Broadcast<2>(u)};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto g = load_gradient<Wide>(at + 8 * c);
    for (std::size_t r = 0; r < 3; ++r) sum[3 * c + r] = hn::MulAdd(component[r], g, sum[3 * c + r]);
  }
}

template <class Wide = Eight>
HWY_INLINE void quad_gradients(const PointBlock& block, std::size_t quad, const float* HWY_RESTRICT values,
                               float* HWY_RESTRICT out) {
  constexpr std::size_t nodes_per_vector = hn::MaxLanes(Wide()) / 4;
  const Wide d;
  const Four d4;
  const std::uint16_t* HWY_RESTRICT node = block.quad_node.data();
  const std::int16_t* HWY_RESTRICT shape = block.quad_gradient.data();
  const std::size_t begin = block.quad_begin[quad], end = block.quad_begin[quad + 1];
  hn::Vec<Wide> sum[2 / nodes_per_vector][9];
  for (auto& s : sum)
    for (auto& x : s) x = hn::Zero(d);
  if constexpr (nodes_per_vector == 2) {
    for (std::size_t k = begin; k < end; k += 2)
      add_node<Wide>(hn::Combine(d, hn::LoadU(d4, values + 4 * std::size_t(node[k + 1])),
                                 hn::LoadU(d4, values + 4 * std::size_t(node[k]))),
                     shape + 12 * k, sum[0]);
    for (std::size_t n = 0; n < 9; ++n)
      hn::StoreU(hn::Add(hn::LowerHalf(d4, sum[0][n]), hn::UpperHalf(d4, sum[0][n])), d4, out + batch * n);
  } else {
    for (std::size_t k = begin; k < end; k += 2)
      for (std::size_t h = 0; h < 2; ++h)
        add_node<Wide>(hn::LoadU(d, values + 4 * std::size_t(node[k + h])), shape + 12 * k + 4 * h, sum[h]);
    for (std::size_t n = 0; n < 9; ++n) hn::StoreU(hn::Add(sum[0][n], sum[1][n]), d, out + batch * n);
  }
}

template <class Wide = Eight>
HWY_INLINE void quad_divergence(const PointBlock& block, std::size_t quad, const float* HWY_RESTRICT stress,
                                float* HWY_RESTRICT out) {
  constexpr std::size_t nodes_per_vector = hn::MaxLanes(Wide()) / 4;
  const Wide d;
  const Four d4;
  const std::uint16_t* HWY_RESTRICT node = block.quad_node.data();
  const std::int16_t* HWY_RESTRICT shape = block.quad_gradient.data();
  hn::Vec<Wide> s[9];
  for (std::size_t n = 0; n < 9; ++n) s[n] = hn::LoadDup128(d, stress + batch * n);
  // The force on a node: the sum over four points.
  const auto force = [&](const std::int16_t* at) HWY_ATTR {
    const hn::Vec<Wide> g[3] = {load_gradient<Wide>(at), load_gradient<Wide>(at + 8), load_gradient<Wide>(at + 16)};
    const auto row = [&](std::size_t r) HWY_ATTR {
      return hn::MulAdd(s[6 + r], g[2], hn::MulAdd(s[3 + r], g[1], hn::Mul(s[r], g[0])));
    };
    const auto x = row(0), y = row(1), z = row(2), zero = hn::Zero(d);
    const auto xz = hn::Add(hn::InterleaveLower(d, x, z), hn::InterleaveUpper(d, x, z)),
               y0 = hn::Add(hn::InterleaveLower(d, y, zero), hn::InterleaveUpper(d, y, zero));
    return hn::Add(hn::InterleaveLower(d, xz, y0), hn::InterleaveUpper(d, xz, y0));
  };
  const auto add = [&](std::size_t k, hn::Vec<Four> f) HWY_ATTR {
    float* const at = out + 4 * std::size_t(node[k]);
    hn::StoreU(hn::Add(hn::LoadU(d4, at), f), d4, at);
  };
  for (std::size_t k = block.quad_begin[quad]; k < block.quad_begin[quad + 1]; k += 2) {
    if constexpr (nodes_per_vector == 2) {
      const auto f = force(shape + 12 * k);
      add(k, hn::LowerHalf(d4, f));
      add(k + 1, hn::UpperHalf(d4, f));
    } else {
      add(k, force(shape + 12 * k));
      add(k + 1, force(shape + 12 * k + 4));
    }
  }
}
#endif

// a0 b0 + a1 b1 + a2 b2.
HWY_INLINE V<float> fused_dot(V<float> a0, V<float> b0, V<float> a1, V<float> b1, V<float> a2, V<float> b2) {
  return hn::MulAdd(a2, b2, hn::MulAdd(a1, b1, hn::Mul(a0, b0)));
}
// Matrix product a · b.
HWY_INLINE Matrix<float> fused_product(const Matrix<float>& a, const Matrix<float>& b) {
  Matrix<float> m;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      m.at[c][r] = fused_dot(a.at[0][r], b.at[c][0], a.at[1][r], b.at[c][1], a.at[2][r], b.at[c][2]);
  return m;
}

// Replaces gradients of points from `first` on, in multiples of their quantum, by their stresses
// times the quantum.
HWY_INLINE void apply_modes(const PointBlock& block, const StiffnessModes& modes, std::size_t first, std::size_t count,
                            float* HWY_RESTRICT gradient) {
  const Lanes<float> d;
  const hn::Rebind<std::int32_t, Lanes<float>> d32;
  const hn::Rebind<std::int16_t, Lanes<float>> d16;
  for (std::size_t i = 0; i < count; i += width<float>) {
    const std::int16_t* const frame_of_points = &modes.frame[modes.offset(first + i, 18)];
    const float* const stiffness = &modes.stiffness[modes.offset(first + i, 12)];
    const auto frame = [&](std::size_t k) HWY_ATTR {
      return hn::ConvertTo(d, hn::PromoteTo(d32, hn::LoadU(d16, frame_of_points + 8 * k)));
    };
    const auto number = [&](std::size_t k) HWY_ATTR { return hn::LoadU(d, stiffness + 8 * k); };
    Matrix<float> u, v;
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t r = 0; r < 3; ++r) {
        u.at[c][r] = frame(3 * c + r);
        v.at[c][r] = frame(9 + 3 * c + r);
      }
    const auto quantum = hn::Mul(hn::LoadU(d, block.quantum.data() + first + i),
                                 hn::Set(d, 1 / (StiffnessModes::frame_scale * StiffnessModes::frame_scale)));
    Matrix<float> at, out;
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t r = 0; r < 3; ++r) at.at[c][r] = hn::LoadU(d, gradient + batch * (3 * c + r) + i);
    Matrix<float> in = fused_product(transposed(u), fused_product(at, v));
    for (auto& column : in.at)
      for (auto& x : column) x = hn::Mul(x, quantum);
    const V<float> a[3][3] = {
        {number(0), number(3), number(4)}, {number(3), number(1), number(5)}, {number(4), number(5), number(2)}};
    for (int k = 0; k < 3; ++k)
      out.at[k][k] = fused_dot(a[k][0], in.at[0][0], a[k][1], in.at[1][1], a[k][2], in.at[2][2]);
    for (std::size_t k = 0; k < 3; ++k) {
      const int p = k == 2 ? 1 : 0, q = k == 0 ? 1 : 2;
      const auto diagonal = number(6 + 2 * k), off_diagonal = number(7 + 2 * k);
      out.at[p][q] = hn::MulAdd(diagonal, in.at[p][q], hn::Mul(off_diagonal, in.at[q][p]));
      out.at[q][p] = hn::MulAdd(diagonal, in.at[q][p], hn::Mul(off_diagonal, in.at[p][q]));
    }
    for (auto& column : out.at)
      for (auto& x : column) x = hn::Mul(x, quantum);
    at = fused_product(fused_product(u, out), transposed(v));
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t r = 0; r < 3; ++r) hn::StoreU(at.at[c][r], d, gradient + batch * (3 * c + r) + i);
  }
}

void Stiffness(const PointBlock& block, const StiffnessModes& modes, const float* HWY_RESTRICT values,
               float* HWY_RESTRICT out) {
  HWY_ALIGN float numbers[9 * batch];
  for (std::size_t first = 0; first < modes.points; first += batch) {
    const std::size_t count = std::min(batch, modes.points - first);
    for (std::size_t i = 0; i < count; i += 4) quad_gradients(block, (first + i) / 4, values, numbers + i);
    apply_modes(block, modes, first, count, numbers);
    for (std::size_t i = 0; i < count; i += 4) quad_divergence(block, (first + i) / 4, numbers + i, out);
  }
}

// From a batch to PointMatrices: times the points' quanta, plus `affine`.
HWY_INLINE void to_columns(const float* HWY_RESTRICT numbers, const float* HWY_RESTRICT quantum,
                           const double* HWY_RESTRICT affine, std::size_t first, std::size_t count,
                           double* const* HWY_RESTRICT out) {
  const Lanes<float> d;
  HWY_ALIGN float rows[4 * width<float>];
  for (std::size_t i = 0; i < count; i += width<float>) {
    const auto by = hn::LoadU(d, quantum + first + i);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto number = [&](std::size_t r)
                              HWY_ATTR { return hn::Mul(by, hn::LoadU(d, numbers + batch * (3 * c + r) + i)); };
      hn::StoreInterleaved4(number(0), number(1), number(2), hn::Zero(d), d, rows);
      double* const to = out[c] + 4 * (first + i);
      for (std::size_t k = 0; k < width<float>; ++k)
        for (std::size_t r = 0; r < 4; ++r)
          to[4 * k + r] = quantum[first + i + k] > 0 ? double(rows[4 * k + r]) + affine[4 * c + r] : 0;
    }
  }
}
// From PointMatrices to a batch, times the points' quanta.
HWY_INLINE void from_columns(const double* const* HWY_RESTRICT columns, const float* HWY_RESTRICT quantum,
                             std::size_t first, std::size_t count, float* HWY_RESTRICT numbers) {
  const Lanes<float> d;
  HWY_ALIGN float rows[4 * width<float>];
  for (std::size_t i = 0; i < count; i += width<float>) {
    const auto by = hn::LoadU(d, quantum + first + i);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t k = 0; k < 4 * width<float>; ++k) rows[k] = float(columns[c][4 * (first + i) + k]);
      V<float> x, y, z, none;
      hn::LoadInterleaved4(d, rows, x, y, z, none);
      hn::StoreU(hn::Mul(by, x), d, numbers + batch * (3 * c) + i);
      hn::StoreU(hn::Mul(by, y), d, numbers + batch * (3 * c + 1) + i);
      hn::StoreU(hn::Mul(by, z), d, numbers + batch * (3 * c + 2) + i);
    }
  }
}

void QuantisedGradients(const PointBlock& block, const float* HWY_RESTRICT values, const double* HWY_RESTRICT affine,
                        double* const* HWY_RESTRICT out) {
  HWY_ALIGN float numbers[9 * batch];
  for (std::size_t first = 0; first < block.quantum.size(); first += batch) {
    const std::size_t count = std::min(batch, block.quantum.size() - first);
    for (std::size_t i = 0; i < count; i += 4) quad_gradients(block, (first + i) / 4, values, numbers + i);
    to_columns(numbers, block.quantum.data(), affine, first, count, out);
  }
}

void QuantisedDivergence(const PointBlock& block, const double* const* HWY_RESTRICT stress, float* HWY_RESTRICT out) {
  HWY_ALIGN float numbers[9 * batch];
  for (std::size_t first = 0; first < block.quantum.size(); first += batch) {
    const std::size_t count = std::min(batch, block.quantum.size() - first);
    from_columns(stress, block.quantum.data(), first, count, numbers);
    for (std::size_t i = 0; i < count; i += 4) quad_divergence(block, (first + i) / 4, numbers + i, out);
  }
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(Stiffness);
HWY_EXPORT(QuantisedGradients);
HWY_EXPORT(QuantisedDivergence);

void multiply_stiffness(const PointBlock& block, const StiffnessModes& modes, const float* values, float* out) {
  HWY_DYNAMIC_DISPATCH(Stiffness)(block, modes, values, out);
}

void quantised_gradients(const PointBlock& block, const float* values, const Mat3& affine, PointMatrices<double>& out) {
  out.resize(block.points.size());
  double* const columns[3] = {out.column[0].data(), out.column[1].data(), out.column[2].data()};
  double padded[12] = {};
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) padded[4 * c + r] = affine(r, c);
  HWY_DYNAMIC_DISPATCH(QuantisedGradients)(block, values, padded, columns);
}
void quantised_divergence(const PointBlock& block, const PointMatrices<double>& stress, float* out) {
  const double* const columns[3] = {stress.column[0].data(), stress.column[1].data(), stress.column[2].data()};
  HWY_DYNAMIC_DISPATCH(QuantisedDivergence)(block, columns, out);
}

}  // namespace geo
#endif
