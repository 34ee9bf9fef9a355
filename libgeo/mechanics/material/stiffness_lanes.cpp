// F = U Σ Vᵀ by cyclic Jacobi on FᵀF, then ∂²Ψ/∂F² in the principal frame with negative eigenvalues
// set to zero (Stomakhin et al. 2012; Smith, de Goes and Kim 2018). Compiled for each
// instruction set (base/simd_targets.h); all give the same bits.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/material/stiffness_lanes.cpp"
#include "base/simd_targets.h"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <algorithm>
#include <array>

#include "hwy/highway.h"
#include "mechanics/material/matrix_lanes.h"
#include "mechanics/material/stiffness_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {

using Vector = V<float>;

// Cyclic Jacobi on symmetric matrices, a[j][i] = a[i][j]: eigenvalues end on the diagonal,
// eigenvectors are the columns of `vectors`. A rotation is skipped if its off-diagonal entry is
// below 1e-8 of the diagonal, less than single precision resolves. At most four sweeps; a sweep
// that skips all is the last. Precondition: squares of the entries are finite. Two sets of matrices
// alternate, because each rotation waits for the one before: one set's square roots and divisions
// hide the other's latency.
constexpr int sets = 2;
HWY_INLINE void diagonalise(Vector (&all)[sets][3][3], Matrix<float> (&vectors)[sets]) {
  const Lanes<float> d;
  const auto one = hn::Set(d, 1.0f), zero = hn::Zero(d), two = hn::Set(d, 2.0f), rounding = hn::Set(d, 1e-8f),
             tiny = hn::Set(d, 1e-18f);
  for (auto& v : vectors)
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) v.at[c][r] = c == r ? one : zero;
  bool done = false;
  for (int sweep = 0; sweep < 4 && !done; ++sweep) {
    done = true;
    for (int k = 0; k < 3; ++k) {
      const int p = k == 2 ? 1 : 0, q = k == 0 ? 1 : 2, r = 3 - p - q;
      const auto is_needed = [&](const Vector(&a)[3][3]) HWY_ATTR {
        return hn::Gt(hn::Abs(a[p][q]), hn::Max(hn::Mul(rounding, hn::Max(hn::Abs(a[p][p]), hn::Abs(a[q][q]))), tiny));
      };
      const hn::Mask<Lanes<float>> needed[sets] = {is_needed(all[0]), is_needed(all[1])};
      if (hn::AllFalse(d, hn::Or(needed[0], needed[1]))) continue;
      done = false;
      Vector c[sets], s[sets];
      for (int m = 0; m < sets; ++m) {
        auto& a = all[m];
        const auto rotates = needed[m];
        const auto apq = a[p][q], twice = hn::Mul(two, apq), difference = hn::Sub(a[q][q], a[p][p]);
        // tan of the angle: the smaller root of t² + (a_qq − a_pp) / a_pq t − 1 = 0.
        const auto root = hn::Sqrt(hn::Add(hn::Mul(difference, difference), hn::Mul(twice, twice)));
        const auto t =
            hn::IfThenElseZero(rotates, hn::Div(hn::CopySign(twice, hn::Xor(twice, difference)),
                                                hn::IfThenElse(rotates, hn::Add(hn::Abs(difference), root), one)));
        const auto step = hn::Mul(t, apq);
        c[m] = hn::Div(one, hn::Sqrt(hn::Add(hn::Mul(t, t), one)));
        s[m] = hn::Mul(t, c[m]);
        a[p][p] = hn::Sub(a[p][p], step);
        a[q][q] = hn::Add(a[q][q], step);
        a[p][q] = a[q][p] = hn::IfThenElse(rotates, zero, apq);
      }
      for (int m = 0; m < sets; ++m) {
        auto& a = all[m];
        const auto arp = a[r][p], arq = a[r][q];
        a[r][p] = a[p][r] = hn::Sub(hn::Mul(c[m], arp), hn::Mul(s[m], arq));
        a[r][q] = a[q][r] = hn::Add(hn::Mul(s[m], arp), hn::Mul(c[m], arq));
        for (int i = 0; i < 3; ++i) {
          const auto vp = vectors[m].at[p][i], vq = vectors[m].at[q][i];
          vectors[m].at[p][i] = hn::Sub(hn::Mul(c[m], vp), hn::Mul(s[m], vq));
          vectors[m].at[q][i] = hn::Add(hn::Mul(s[m], vp), hn::Mul(c[m], vq));
        }
      }
    }
  }
}

// s = FᵀF.
HWY_INLINE void right_cauchy_green(const Matrix<float>& f, Vector (&s)[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) s[i][j] = dot3(f.at[i], f.at[j]);
}

// F = U Σ Vᵀ with rotations U and V and |σ₀| ≥ |σ₁| ≥ |σ₂|; σ₂ is negative where det F is. In: the
// diagonalised FᵀF `s` and its eigenvectors `v`; out, reordered, `v`.
HWY_INLINE void decompose(const Matrix<float>& f, Vector (&s)[3][3], Matrix<float>& u, Vector (&sigma)[3],
                          Matrix<float>& v) {
  const Lanes<float> d;
  const auto tiny = hn::Set(d, 1e-20f), one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  for (int k = 0; k < 3; ++k) {
    const int p = k == 1 ? 1 : 0, q = p + 1;
    const auto swap = hn::Lt(s[p][p], s[q][q]);
    const auto sp = s[p][p];
    s[p][p] = hn::IfThenElse(swap, s[q][q], sp);
    s[q][q] = hn::IfThenElse(swap, sp, s[q][q]);
    for (int i = 0; i < 3; ++i) {
      const auto vp = v.at[p][i];
      v.at[p][i] = hn::IfThenElse(swap, v.at[q][i], vp);
      v.at[q][i] = hn::IfThenElse(swap, hn::Neg(vp), v.at[q][i]);
    }
  }
  Vector b[3][3];
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      b[c][r] = hn::Add(hn::Add(hn::Mul(f.at[0][r], v.at[c][0]), hn::Mul(f.at[1][r], v.at[c][1])),
                        hn::Mul(f.at[2][r], v.at[c][2]));
  const auto length = hn::Sqrt(dot3(b[0], b[0]));
  const auto is_zero = hn::Lt(length, tiny);
  const auto inverse = hn::Div(one, hn::IfThenElse(is_zero, one, length));
  for (int r = 0; r < 3; ++r) u.at[0][r] = hn::IfThenElse(is_zero, r == 0 ? one : zero, hn::Mul(b[0][r], inverse));
  const auto component = dot3(u.at[0], b[1]);
  for (int r = 0; r < 3; ++r) b[1][r] = hn::Sub(b[1][r], hn::Mul(component, u.at[0][r]));
  // A second column shorter than 1e-6 of the first vanishes: any direction normal to the first.
  const auto second = dot3(b[1], b[1]);
  const auto vanishes = hn::Lt(second, hn::Max(hn::Mul(hn::Set(d, 1e-12f), hn::Mul(length, length)), tiny));
  const auto x_is_small = hn::Lt(hn::Abs(u.at[0][0]), hn::Set(d, 0.7f));
  const Vector normal[3] = {hn::IfThenElse(x_is_small, zero, hn::Neg(u.at[0][2])),
                            hn::IfThenElse(x_is_small, u.at[0][2], zero),
                            hn::IfThenElse(x_is_small, hn::Neg(u.at[0][1]), u.at[0][0])};
  for (int r = 0; r < 3; ++r) b[1][r] = hn::IfThenElse(vanishes, normal[r], b[1][r]);
  const auto unit = hn::Div(one, hn::Sqrt(dot3(b[1], b[1])));
  for (int r = 0; r < 3; ++r) u.at[1][r] = hn::Mul(b[1][r], unit);
  for (int r = 0; r < 3; ++r) {
    const int i = (r + 1) % 3, j = (r + 2) % 3;
    u.at[2][r] = hn::Sub(hn::Mul(u.at[0][i], u.at[1][j]), hn::Mul(u.at[0][j], u.at[1][i]));
  }
  sigma[0] = length;
  sigma[1] = hn::IfThenElse(vanishes, zero, hn::Sqrt(second));
  sigma[2] = dot3(u.at[2], b[2]);
}

// Stiffness in the principal frame, as functions of the singular values σ. ψᵢ = ∂Ψ/∂σᵢ. The divided
// differences of the 2×2 blocks are expanded, so that equal singular values need no division.
struct Principal {
  Vector a[3][3];     // ∂²Ψ/∂σᵢ∂σⱼ
  Vector stretch[3];  // per pair 01, 02, 12: (ψᵢ − ψⱼ)/(σᵢ − σⱼ), eigenvalue of the symmetric mode
  Vector twist[3];    // (ψᵢ + ψⱼ)/(σᵢ + σⱼ), eigenvalue of the antisymmetric mode
};

HWY_INLINE Principal principal(const StiffnessConstants& m, const Vector (&s)[3]) {
  const Lanes<float> d;
  const auto one = hn::Set(d, 1.0f), mu = hn::Set(d, m.mu), lambda = hn::Set(d, m.lambda),
             volume = hn::Set(d, m.volume);
  const Vector cof[3] = {hn::Mul(s[1], s[2]), hn::Mul(s[0], s[2]), hn::Mul(s[0], s[1])};
  const auto j = hn::Mul(s[0], cof[0]),
             square = hn::Add(hn::Add(hn::Mul(s[0], s[0]), hn::Mul(s[1], s[1])), hn::Mul(s[2], s[2]));
  Principal p;
  const auto pressure = hn::Add(hn::Mul(volume, hn::Sub(j, one)),
                                m.neo_hookean ? hn::Mul(lambda, hn::Sub(j, hn::Set(d, m.alpha))) : hn::Zero(d));
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
    const auto pressure_term = hn::Mul(pressure, s[3 - i - l]);
    auto stretch = shear, twist = shear;
    if (!m.neo_hookean) {
      const auto squares = hn::Add(hn::Mul(s[i], s[i]), hn::Mul(s[l], s[l])), both = hn::Mul(s[i], s[l]);
      stretch = hn::Add(green, hn::Mul(mu, hn::Add(squares, both)));
      twist = hn::Add(green, hn::Mul(mu, hn::Sub(squares, both)));
    }
    p.stretch[k] = hn::Max(hn::Sub(stretch, pressure_term), hn::Zero(d));
    p.twist[k] = hn::Max(hn::Add(twist, pressure_term), hn::Zero(d));
  }
  return p;
}

// The stiffness of points in their principal frame.
struct PrincipalFrame {
  const Matrix<float>& u;             // F = U Σ Vᵀ
  Matrix<float>& v;                   // write() applies plastic strain to it
  const Principal& stiffness;         // on the diagonal of its 3×3 matrix: eigenvalues over `scale`
  const Matrix<float>& eigenvectors;  // of that matrix
  float scale;
};

// Writes the modes of points from i on. `inverse_stretch`: the columns of inverse plastic
// stretches, or null.
HWY_INLINE void write(const StiffnessConstants& material, std::size_t i, const PrincipalFrame& principal_frame,
                      const float* const* inverse_stretch, const float* weight, StiffnessModes& out) {
  const Matrix<float>&u = principal_frame.u, &e = principal_frame.eigenvectors;
  Matrix<float>& v = principal_frame.v;
  const Principal& p = principal_frame.stiffness;
  const Lanes<float> d;
  const hn::Rebind<std::int32_t, Lanes<float>> d32;
  const hn::Rebind<std::int16_t, Lanes<float>> d16;
  const auto one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f), full = hn::Set(d, StiffnessModes::frame_scale),
             stiffness_scale = hn::Set(d, principal_frame.scale);
  // With plastic strain V is no rotation. Its entries are scaled to at most 1, and the stiffness by
  // the square.
  Vector longest = one;
  if (inverse_stretch) {
    v = product(load(inverse_stretch, i), v);
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) longest = hn::Max(longest, hn::Abs(v.at[c][r]));
  }
  std::int16_t* const frame = &out.frame[out.offset(i, 18)];
  const auto put = [&](std::size_t k, Vector x) HWY_ATTR {
    hn::StoreU(hn::DemoteTo(d16, hn::ConvertTo(d32, hn::Add(x, hn::CopySign(half, x)))), d16, frame + 8 * k);
  };
  const auto shorter = hn::Div(full, longest);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t r = 0; r < 3; ++r) {
      put(3 * c + r, hn::Mul(u.at[c][r], full));
      put(9 + 3 * c + r, hn::Mul(v.at[c][r], shorter));
    }
  const auto w = hn::Mul(hn::LoadU(d, weight + i), hn::Mul(longest, longest));
  float* const to = &out.stiffness[out.offset(i, 12)];
  Vector kept[3];
  for (int k = 0; k < 3; ++k) kept[k] = hn::Mul(hn::Mul(w, stiffness_scale), hn::Max(p.a[k][k], hn::Zero(d)));
  const auto viscous = hn::Mul(w, hn::Set(d, material.viscous));
  constexpr int rows[6] = {0, 1, 2, 0, 0, 1}, cols[6] = {0, 1, 2, 1, 2, 2};
  for (std::size_t k = 0; k < 6; ++k) {
    const int r = rows[k], c = cols[k];
    auto sum = hn::Mul(kept[0], hn::Mul(e.at[0][r], e.at[0][c]));
    for (int q = 1; q < 3; ++q) sum = hn::Add(sum, hn::Mul(kept[q], hn::Mul(e.at[q][r], e.at[q][c])));
    hn::StoreU(k < 3 ? hn::Add(sum, viscous) : sum, d, to + 8 * k);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    hn::StoreU(hn::Mul(half, hn::Add(hn::Mul(w, hn::Add(p.stretch[k], p.twist[k])), viscous)), d, to + 8 * (6 + 2 * k));
    hn::StoreU(hn::Mul(half, hn::Add(hn::Mul(w, hn::Sub(p.stretch[k], p.twist[k])), viscous)), d, to + 8 * (7 + 2 * k));
  }
}

void Modes(const StiffnessConstants& material, PointRange range, const PointMatrices<float>& gradient,
           const PointMatrices<float>* inverse_stretch, const float* weight, StiffnessModes& out) {
  const Lanes<float> d;
  const auto columns_of = [](const PointMatrices<float>& c) {
    return std::array{c.column[0].data(), c.column[1].data(), c.column[2].data()};
  };
  const auto columns = columns_of(gradient), stretch_columns = inverse_stretch ? columns_of(*inverse_stretch) : columns;
  const float scale = material.mu + material.lambda + material.volume;
  const auto one = hn::Set(d, 1.0f), one_over_scale = hn::Set(d, 1 / scale);
  for (std::size_t i = range.begin; i < range.end; i += sets * width<float>) {
    const std::size_t at[sets] = {i, std::min(i + width<float>, range.end - width<float>)};  // an odd last one twice
    Matrix<float> f[sets], u[sets], v[sets], e[sets];
    Vector sigma[3], s[sets][3][3], a[sets][3][3];
    for (int m = 0; m < sets; ++m) {
      f[m] = load(columns.data(), at[m]);
      for (int c = 0; c < 3; ++c) f[m].at[c][c] = hn::Add(f[m].at[c][c], one);
      right_cauchy_green(f[m], s[m]);
    }
    diagonalise(s, v);
    Principal p[sets];
    for (int m = 0; m < sets; ++m) {
      decompose(f[m], s[m], u[m], sigma, v[m]);
      p[m] = principal(material, sigma);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) a[m][r][c] = hn::Mul(p[m].a[r][c], one_over_scale);
    }
    diagonalise(a, e);
    for (int m = 0; m < sets; ++m) {
      for (int k = 0; k < 3; ++k) p[m].a[k][k] = a[m][k][k];
      write(material, at[m], {u[m], v[m], p[m], e[m], scale}, inverse_stretch ? stretch_columns.data() : nullptr,
            weight, out);
    }
  }
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(Modes);

void stiffness_modes(const StiffnessConstants& constants, PointRange range,
                     const PointMatrices<float>& elastic_gradient, const PointMatrices<float>* relaxation,
                     const std::vector<float>& weight, StiffnessModes& out) {
  HWY_DYNAMIC_DISPATCH(Modes)(constants, range, elastic_gradient, relaxation, weight.data(), out);
}

void StiffnessModes::copy_point(const StiffnessModes& from, std::size_t point) {
  for (std::size_t k = 0; k < 18; ++k) frame[offset(point, 18) + 8 * k] = from.frame[offset(point, 18) + 8 * k];
  for (std::size_t k = 0; k < 12; ++k) stiffness[offset(point, 12) + 8 * k] = from.stiffness[offset(point, 12) + 8 * k];
}

Eigen::Matrix3f StiffnessModes::rotation(std::size_t point) const {
  Eigen::Matrix3f u, v;
  const std::int16_t* const from = &frame[offset(point, 18)];
  for (std::size_t k = 0; k < 9; ++k) {
    u.data()[k] = from[8 * k];
    v.data()[k] = from[8 * (9 + k)];
  }
  return u * v.transpose() / (frame_scale * frame_scale);
}

}  // namespace geo
#endif
