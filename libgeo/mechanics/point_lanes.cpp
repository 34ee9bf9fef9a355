// Highway compiles the part between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each kind of vector. No operation
// is fused and each lane has its own sum, so all kinds find the same numbers.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/point_lanes.cpp"
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_AVX3_DL)
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <algorithm>

#include "hwy/highway.h"
#include "mechanics/point_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class Number>
HWY_INLINE const Number* entries(const PointBlock& block);
template <>
HWY_INLINE const double* entries<double>(const PointBlock& block) {
  return block.gradient.data();
}
template <>
HWY_INLINE const float* entries<float>(const PointBlock& block) {
  return block.rounded.data();
}

// Of points from `from` on, into columns that begin with it.
template <class Number>
HWY_INLINE void gradients_of(const PointBlock& block, std::size_t from, std::size_t end_point, const Number* values, Number* const* out) {
  using Tag = hn::CappedTag<Number, 4>;
  const Tag d;
  constexpr std::size_t step = hn::MaxLanes(Tag());
  const std::uint16_t* to = block.to.data();
  const Number* g = entries<Number>(block);
  for (std::size_t i = from; i < end_point; ++i) {
    const std::size_t begin = block.first[i], end = block.first[i + 1];
    for (std::size_t at = 0; at < 4; at += step) {
      auto x = hn::Zero(d), y = x, z = x;
      for (std::size_t q = begin; q < end; ++q) {
        const auto u = hn::LoadU(d, values + 4 * to[q] + at);
        x = hn::Add(x, hn::Mul(u, hn::Set(d, g[3 * q])));
        y = hn::Add(y, hn::Mul(u, hn::Set(d, g[3 * q + 1])));
        z = hn::Add(z, hn::Mul(u, hn::Set(d, g[3 * q + 2])));
      }
      hn::StoreU(x, d, out[0] + 4 * (i - from) + at);
      hn::StoreU(y, d, out[1] + 4 * (i - from) + at);
      hn::StoreU(z, d, out[2] + 4 * (i - from) + at);
    }
  }
}

template <class Number>
HWY_INLINE void divergence_of(const PointBlock& block, std::size_t from, std::size_t end_point, const Number* const* stress, Number* out) {
  using Tag = hn::CappedTag<Number, 4>;
  const Tag d;
  constexpr std::size_t step = hn::MaxLanes(Tag());
  const std::uint16_t* to = block.to.data();
  const Number* g = entries<Number>(block);
  for (std::size_t i = from; i < end_point; ++i) {
    const std::size_t begin = block.first[i], end = block.first[i + 1], place = 4 * (i - from);
    for (std::size_t at = 0; at < 4; at += step) {
      const auto x = hn::LoadU(d, stress[0] + place + at), y = hn::LoadU(d, stress[1] + place + at), z = hn::LoadU(d, stress[2] + place + at);
      for (std::size_t q = begin; q < end; ++q) {
        Number* const f = out + 4 * to[q] + at;
        const auto sum = hn::Add(hn::Add(hn::Mul(x, hn::Set(d, g[3 * q])), hn::Mul(y, hn::Set(d, g[3 * q + 1]))), hn::Mul(z, hn::Set(d, g[3 * q + 2])));
        hn::StoreU(hn::Add(hn::LoadU(d, f), sum), d, f);
      }
    }
  }
}

void GradientsDouble(const PointBlock& block, const double* values, Columns<double>& out) {
  double* const columns[3] = {out.column[0].data(), out.column[1].data(), out.column[2].data()};
  gradients_of(block, 0, block.points.size(), values, columns);
}
void DivergenceDouble(const PointBlock& block, const Columns<double>& stress, double* out) {
  const double* const columns[3] = {stress.column[0].data(), stress.column[1].data(), stress.column[2].data()};
  divergence_of(block, 0, block.points.size(), columns, out);
}

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void gradients_wide(const PointBlock& block, std::size_t from, std::size_t to_point, const float* values, float* const* out) {
  gradients_of(block, from, to_point, values, out);
}
#else
// As gradients_of, with all three columns of a point side by side, and two points at once: each sum waits for the one before.
HWY_INLINE void gradients_wide(const PointBlock& block, std::size_t from, std::size_t end_point, const float* values, float* const* out) {
  using Tag = hn::CappedTag<float, 16>;
  const Tag d;
  const hn::Repartition<std::uint8_t, Tag> bytes;
  constexpr std::size_t lanes = hn::MaxLanes(Tag()), vectors = (12 + lanes - 1) / lanes;
  if constexpr (lanes < 8) return gradients_of(block, from, end_point, values, out);
  // Byte 4 l + k of the pattern: where in a block of four numbers that of lane l, column l / 4, has its k-th byte.
  HWY_ALIGN std::uint8_t order[64];
  for (std::size_t l = 0; l < 16; ++l)
    for (std::size_t k = 0; k < 4; ++k) order[4 * l + k] = static_cast<std::uint8_t>(4 * (l / 4) + k);
  hn::Vec<decltype(bytes)> spread[vectors];
  for (std::size_t v = 0; v < vectors; ++v) spread[v] = hn::LoadU(bytes, order + 4 * lanes * v);
  const std::uint16_t* const to = block.to.data();
  const float* const g = block.rounded.data();
  const auto add = [&](hn::Vec<Tag>* sum, std::size_t q) HWY_ATTR {
    const auto u = hn::LoadDup128(d, values + 4 * to[q]);
    const auto entry = hn::BitCast(bytes, hn::LoadDup128(d, g + 3 * q));
    for (std::size_t v = 0; v < vectors; ++v) sum[v] = hn::Add(sum[v], hn::Mul(u, hn::BitCast(d, hn::TableLookupBytes(entry, spread[v]))));
  };
  const auto store = [&](const hn::Vec<Tag>* sum, std::size_t i) HWY_ATTR {
    HWY_ALIGN float numbers[16];
    for (std::size_t v = 0; v < vectors; ++v) hn::StoreU(sum[v], d, numbers + lanes * v);
    for (std::size_t c = 0; c < 3; ++c) std::copy_n(numbers + 4 * c, 4, out[c] + 4 * (i - from));
  };
  for (std::size_t i = from; i < end_point; i += 2) {
    hn::Vec<Tag> even[vectors], odd[vectors];
    for (std::size_t v = 0; v < vectors; ++v) even[v] = odd[v] = hn::Zero(d);
    std::size_t a = block.first[i], b = block.first[i + 1];
    const std::size_t a_end = b, b_end = i + 1 < end_point ? block.first[i + 2] : b;
    for (; a < a_end && b < b_end; ++a, ++b) add(even, a), add(odd, b);
    for (; a < a_end; ++a) add(even, a);
    for (; b < b_end; ++b) add(odd, b);
    store(even, i);
    if (i + 1 < end_point) store(odd, i + 1);
  }
}
#endif

using Lanes = hn::CappedTag<float, 8>;
using V = hn::Vec<Lanes>;
constexpr std::size_t width = hn::MaxLanes(Lanes());

struct Matrix {
  V at[3][3];  // [column][row]
};

HWY_INLINE V dot3(const V* a, const V* b) { return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2])); }

HWY_INLINE Matrix load(const float* const* columns, std::size_t i) {
  Matrix m;
  V unused;
  for (std::size_t c = 0; c < 3; ++c) hn::LoadInterleaved4(Lanes(), columns[c] + 4 * i, m.at[c][0], m.at[c][1], m.at[c][2], unused);
  return m;
}
HWY_INLINE void store(const Matrix& m, float* const* columns, std::size_t i) {
  for (std::size_t c = 0; c < 3; ++c) hn::StoreInterleaved4(m.at[c][0], m.at[c][1], m.at[c][2], hn::Zero(Lanes()), Lanes(), columns[c] + 4 * i);
}

// Cyclic Jacobi on a symmetric matrix, a[j][i] = a[i][j]: eigenvalues on its diagonal, eigenvectors as columns of v.
HWY_INLINE void diagonalise(V (&a)[3][3], Matrix& v) {
  const Lanes d;
  const auto one = hn::Set(d, 1.0f), zero = hn::Zero(d), half = hn::Set(d, 0.5f), tiny = hn::Set(d, 1e-30f);
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) v.at[c][r] = c == r ? one : zero;
  for (int sweep = 0; sweep < 4; ++sweep)
    for (int k = 0; k < 3; ++k) {
      const int p = k == 2 ? 1 : 0, q = k == 0 ? 1 : 2, r = 3 - p - q;
      // tan of the angle: the smaller root of t² + 2 θ t − 1 = 0.
      const auto apq = a[p][q];
      const auto none = hn::Lt(hn::Abs(apq), tiny);
      const auto theta = hn::Div(hn::Mul(half, hn::Sub(a[q][q], a[p][p])), hn::IfThenElse(none, one, apq));
      const auto t = hn::IfThenElse(none, zero, hn::CopySign(hn::Div(one, hn::Add(hn::Abs(theta), hn::Sqrt(hn::Add(hn::Mul(theta, theta), one)))), theta));
      const auto c = hn::Div(one, hn::Sqrt(hn::Add(hn::Mul(t, t), one))), s = hn::Mul(t, c), step = hn::Mul(t, apq);
      a[p][p] = hn::Sub(a[p][p], step), a[q][q] = hn::Add(a[q][q], step);
      a[p][q] = a[q][p] = zero;
      const auto arp = a[r][p], arq = a[r][q];
      a[r][p] = a[p][r] = hn::Sub(hn::Mul(c, arp), hn::Mul(s, arq));
      a[r][q] = a[q][r] = hn::Add(hn::Mul(s, arp), hn::Mul(c, arq));
      for (int i = 0; i < 3; ++i) {
        const auto vp = v.at[p][i], vq = v.at[q][i];
        v.at[p][i] = hn::Sub(hn::Mul(c, vp), hn::Mul(s, vq));
        v.at[q][i] = hn::Add(hn::Mul(s, vp), hn::Mul(c, vq));
      }
    }
}

// F = U Σ Vᵀ with rotations U and V, |σ₀| ≥ |σ₁| ≥ |σ₂|, σ₂ negative where F turns space inside out.
HWY_INLINE void decompose(const Matrix& f, Matrix& u, V (&sigma)[3], Matrix& v) {
  const Lanes d;
  const auto tiny = hn::Set(d, 1e-20f), one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  V s[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) s[i][j] = dot3(f.at[i], f.at[j]);
  diagonalise(s, v);
  for (int k = 0; k < 3; ++k) {
    const int p = k == 1 ? 1 : 0, q = p + 1;
    const auto swap = hn::Lt(s[p][p], s[q][q]);
    const auto sp = s[p][p];
    s[p][p] = hn::IfThenElse(swap, s[q][q], sp), s[q][q] = hn::IfThenElse(swap, sp, s[q][q]);
    for (int i = 0; i < 3; ++i) {
      const auto vp = v.at[p][i];
      v.at[p][i] = hn::IfThenElse(swap, v.at[q][i], vp), v.at[q][i] = hn::IfThenElse(swap, hn::Neg(vp), v.at[q][i]);
    }
  }
  V b[3][3];
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) b[c][r] = hn::Add(hn::Add(hn::Mul(f.at[0][r], v.at[c][0]), hn::Mul(f.at[1][r], v.at[c][1])), hn::Mul(f.at[2][r], v.at[c][2]));
  const auto length = hn::Sqrt(dot3(b[0], b[0]));
  const auto gone = hn::Lt(length, tiny);
  const auto inverse = hn::Div(one, hn::IfThenElse(gone, one, length));
  for (int r = 0; r < 3; ++r) u.at[0][r] = hn::IfThenElse(gone, r == 0 ? one : zero, hn::Mul(b[0][r], inverse));
  const auto along = dot3(u.at[0], b[1]);
  for (int r = 0; r < 3; ++r) b[1][r] = hn::Sub(b[1][r], hn::Mul(along, u.at[0][r]));
  // Where the second column is lost, any direction across the first one.
  const auto second = dot3(b[1], b[1]);
  const auto lost = hn::Lt(second, hn::Max(hn::Mul(hn::Set(d, 1e-12f), hn::Mul(length, length)), tiny));
  const auto flat = hn::Lt(hn::Abs(u.at[0][0]), hn::Set(d, 0.7f));
  const V across[3] = {hn::IfThenElse(flat, zero, hn::Neg(u.at[0][2])), hn::IfThenElse(flat, u.at[0][2], zero), hn::IfThenElse(flat, hn::Neg(u.at[0][1]), u.at[0][0])};
  for (int r = 0; r < 3; ++r) b[1][r] = hn::IfThenElse(lost, across[r], b[1][r]);
  const auto unit = hn::Div(one, hn::Sqrt(dot3(b[1], b[1])));
  for (int r = 0; r < 3; ++r) u.at[1][r] = hn::Mul(b[1][r], unit);
  for (int r = 0; r < 3; ++r) {
    const int i = (r + 1) % 3, j = (r + 2) % 3;
    u.at[2][r] = hn::Sub(hn::Mul(u.at[0][i], u.at[1][j]), hn::Mul(u.at[0][j], u.at[1][i]));
  }
  sigma[0] = length, sigma[1] = hn::IfThenElse(lost, zero, hn::Sqrt(second)), sigma[2] = dot3(u.at[2], b[2]);
}

// What the energies have in common: ∂Ψ/∂σᵢ, its derivatives, and divided differences without a division.
struct Principal {
  V a[3][3];
  V same[3], turned[3];  // of pairs 01, 02, 12: (ψᵢ − ψⱼ)/(σᵢ − σⱼ), (ψᵢ + ψⱼ)/(σᵢ + σⱼ)
};

HWY_INLINE Principal principal(const StiffnessConstants& m, const V (&s)[3]) {
  const Lanes d;
  const auto one = hn::Set(d, 1.0f), mu = hn::Set(d, m.mu), lambda = hn::Set(d, m.lambda), volume = hn::Set(d, m.volume);
  const V cof[3] = {hn::Mul(s[1], s[2]), hn::Mul(s[0], s[2]), hn::Mul(s[0], s[1])};
  const auto j = hn::Mul(s[0], cof[0]), square = hn::Add(hn::Add(hn::Mul(s[0], s[0]), hn::Mul(s[1], s[1])), hn::Mul(s[2], s[2]));
  Principal p;
  const auto pressure = hn::Add(hn::Mul(volume, hn::Sub(j, one)), m.neo_hookean ? hn::Mul(lambda, hn::Sub(j, hn::Set(d, m.alpha))) : hn::Zero(d));
  const auto bulk = m.neo_hookean ? hn::Add(lambda, volume) : volume;
  const auto i1 = hn::Div(one, hn::Add(square, one));
  const auto shear = hn::Mul(mu, hn::Sub(one, i1)), soft = hn::Mul(hn::Mul(hn::Set(d, 2.0f), mu), hn::Mul(i1, i1));
  const auto trace = hn::Mul(hn::Set(d, 0.5f), hn::Sub(square, hn::Set(d, 3.0f)));
  const auto green = hn::Sub(hn::Mul(lambda, trace), mu);  // λ tr E − μ
  for (int i = 0; i < 3; ++i)
    for (int k = i; k < 3; ++k) {
      const auto ss = hn::Mul(s[i], s[k]);
      auto value = hn::Mul(bulk, hn::Mul(cof[i], cof[k]));
      if (m.neo_hookean)
        value = hn::Add(value, hn::Mul(soft, ss));
      else
        value = hn::Add(value, hn::Mul(lambda, ss));
      if (i == k)
        value = hn::Add(value, m.neo_hookean ? shear : hn::Add(green, hn::Mul(hn::Set(d, 3.0f), hn::Mul(mu, ss))));
      else
        value = hn::Add(value, hn::Mul(pressure, s[3 - i - k]));
      p.a[i][k] = p.a[k][i] = value;
    }
  for (int k = 0; k < 3; ++k) {
    const int i = k == 2 ? 1 : 0, l = k == 0 ? 1 : 2;
    const auto turn = hn::Mul(pressure, s[3 - i - l]);
    auto same = shear, turned = shear;
    if (!m.neo_hookean) {
      const auto squares = hn::Add(hn::Mul(s[i], s[i]), hn::Mul(s[l], s[l])), both = hn::Mul(s[i], s[l]);
      same = hn::Add(green, hn::Mul(mu, hn::Add(squares, both))), turned = hn::Add(green, hn::Mul(mu, hn::Sub(squares, both)));
    }
    p.same[k] = hn::Max(hn::Sub(same, turn), hn::Zero(d));
    p.turned[k] = hn::Max(hn::Add(turned, turn), hn::Zero(d));
  }
  return p;
}

void Modes(const StiffnessConstants& material, const Columns<float>& gradient, const float* weight, StiffnessModes& out) {
  const Lanes d;
  const float* const columns[3] = {gradient.column[0].data(), gradient.column[1].data(), gradient.column[2].data()};
  for (std::size_t i = 0; i < out.stride; i += width) {
    Matrix f = load(columns, i), u, v;
    for (int c = 0; c < 3; ++c) f.at[c][c] = hn::Add(f.at[c][c], hn::Set(d, 1.0f));
    V sigma[3];
    decompose(f, u, sigma, v);
    Principal p = principal(material, sigma);
    Matrix e;
    diagonalise(p.a, e);
    const auto w = hn::LoadU(d, weight + i);
    float* const to = out.values.data() + i;
    const std::size_t n = out.stride;
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t r = 0; r < 3; ++r) hn::StoreU(u.at[c][r], d, to + (3 * c + r) * n), hn::StoreU(v.at[c][r], d, to + (9 + 3 * c + r) * n);
    V kept[3];
    for (int k = 0; k < 3; ++k) kept[k] = hn::Mul(w, hn::Max(p.a[k][k], hn::Zero(d)));
    constexpr int rows[6] = {0, 1, 2, 0, 0, 1}, cols[6] = {0, 1, 2, 1, 2, 2};
    for (std::size_t k = 0; k < 6; ++k) {
      const int r = rows[k], c = cols[k];
      auto sum = hn::Mul(kept[0], hn::Mul(e.at[0][r], e.at[0][c]));
      for (int q = 1; q < 3; ++q) sum = hn::Add(sum, hn::Mul(kept[q], hn::Mul(e.at[q][r], e.at[q][c])));
      hn::StoreU(sum, d, to + (18 + k) * n);
    }
    const auto half = hn::Mul(w, hn::Set(d, 0.5f));
    for (std::size_t k = 0; k < 3; ++k) {
      hn::StoreU(hn::Mul(half, hn::Add(p.same[k], p.turned[k])), d, to + (24 + 2 * k) * n);
      hn::StoreU(hn::Mul(half, hn::Sub(p.same[k], p.turned[k])), d, to + (25 + 2 * k) * n);
    }
  }
}

// a · b by columns: out column c = Σ a column k · b[k of column c].
HWY_INLINE Matrix product(const V (&a)[3][3], const V (&b)[3][3]) {
  Matrix m;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) m.at[c][r] = hn::Add(hn::Add(hn::Mul(a[0][r], b[c][0]), hn::Mul(a[1][r], b[c][1])), hn::Mul(a[2][r], b[c][2]));
  return m;
}
HWY_INLINE Matrix transposed(const Matrix& m) {
  Matrix t;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) t.at[c][r] = m.at[r][c];
  return t;
}

// Gradients of points from `first` on become the stresses that belong to them.
HWY_INLINE void apply_modes(const StiffnessModes& modes, std::size_t first, std::size_t count, float* const* gradient) {
  const Lanes d;
  const std::size_t n = modes.stride;
  for (std::size_t i = 0; i < count; i += width) {
    const float* const from = modes.values.data() + first + i;
    const auto number = [&](std::size_t k) { return hn::LoadU(d, from + k * n); };
    Matrix u, v;
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t r = 0; r < 3; ++r) u.at[c][r] = number(3 * c + r), v.at[c][r] = number(9 + 3 * c + r);
    const Matrix g = load(gradient, i), gv = product(g.at, v.at), in = product(transposed(u).at, gv.at);
    Matrix out;
    const V a[3][3] = {{number(18), number(21), number(22)}, {number(21), number(19), number(23)}, {number(22), number(23), number(20)}};
    for (int k = 0; k < 3; ++k) out.at[k][k] = hn::Add(hn::Add(hn::Mul(a[k][0], in.at[0][0]), hn::Mul(a[k][1], in.at[1][1])), hn::Mul(a[k][2], in.at[2][2]));
    for (std::size_t k = 0; k < 3; ++k) {
      const int p = k == 2 ? 1 : 0, q = k == 0 ? 1 : 2;
      const auto own = number(24 + 2 * k), other = number(25 + 2 * k);
      out.at[p][q] = hn::Add(hn::Mul(own, in.at[p][q]), hn::Mul(other, in.at[q][p]));
      out.at[q][p] = hn::Add(hn::Mul(own, in.at[q][p]), hn::Mul(other, in.at[p][q]));
    }
    store(product(product(u.at, out.at).at, transposed(v).at), gradient, i);
  }
}

// A few points at a time, so that what is between the three steps stays at hand.
void Stiffness(const PointBlock& block, const StiffnessModes& modes, const float* values, float* out) {
  constexpr std::size_t batch = 16;
  HWY_ALIGN float numbers[3][4 * batch] = {};
  float* const columns[3] = {numbers[0], numbers[1], numbers[2]};
  for (std::size_t i = 0; i < block.points.size(); i += batch) {
    const std::size_t end = std::min(i + batch, block.points.size());
    gradients_wide(block, i, end, values, columns);
    apply_modes(modes, i, std::min(batch, modes.stride - i), columns);
    divergence_of<float>(block, i, end, columns, out);
  }
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(GradientsDouble);
HWY_EXPORT(DivergenceDouble);
HWY_EXPORT(Modes);
HWY_EXPORT(Stiffness);

template <class Number>
void Columns<Number>::resize(std::size_t points) {
  for (auto& c : column) c.resize(4 * ((points + 7) / 8 * 8));
}
template struct Columns<double>;
template struct Columns<float>;

void point_gradients(const PointBlock& block, const double* values, Columns<double>& out) {
  out.resize(block.points.size());
  HWY_DYNAMIC_DISPATCH(GradientsDouble)(block, values, out);
}
void point_divergence(const PointBlock& block, const Columns<double>& stress, double* out) { HWY_DYNAMIC_DISPATCH(DivergenceDouble)(block, stress, out); }

void stiffness_modes(const StiffnessConstants& constants, const Columns<float>& gradient, const std::vector<float>& weight, StiffnessModes& out) {
  out.stride = weight.size();
  out.values.resize(StiffnessModes::numbers * out.stride);
  HWY_DYNAMIC_DISPATCH(Modes)(constants, gradient, weight.data(), out);
}
void multiply_stiffness(const PointBlock& block, const StiffnessModes& modes, const float* values, float* out) { HWY_DYNAMIC_DISPATCH(Stiffness)(block, modes, values, out); }

}  // namespace geo
#endif
