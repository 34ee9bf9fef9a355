// Energy and stress of both models from invariants of the Green strain, one point per lane; the
// formulas are those of elasticity.cpp. Compiled for each instruction set
// (base/simd_targets.h); all give the same bits.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/material/elastic_lanes.cpp"
#include "base/simd_targets.h"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <algorithm>

#include "hwy/highway.h"
#include "mechanics/material/elastic_lanes.h"
#include "mechanics/material/matrix_lanes.h"

#ifndef KERF_ELASTIC_ARRAYS
#define KERF_ELASTIC_ARRAYS
namespace geo {
namespace {
// The arrays of elastic_response() as pointers; matrices by columns.
struct ElasticArrays {
  const double* volume;
  const double* const* relaxation;  // or null
  const double* const* previous;    // or null
  double* const* gradient;
  double* energy;
  float* const* elastic_gradient;  // or null
};
}  // namespace
}  // namespace geo
#endif

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {

using Tag = Lanes<double>;
using Vector = V<double>;

// x in all lanes.
HWY_INLINE Vector number(double x) { return hn::Set(Tag(), x); }

// log(1 + x), to an ulp or two: 1 + x = 2ᵏ (1 + f) with √½ ≤ 1 + f < √2, and log(1 + f) = 2
// artanh(s) with s = f / (2 + f). The series in z = s² ≤ 0.0295 ends at z¹¹/23: its rest is below
// rounding. ln 2 is split in two constants, as in fdlibm.
HWY_INLINE Vector log1p_lanes(Vector x) {
  const hn::RebindToSigned<Tag> d64;
  const auto one = number(1), y = hn::Add(one, x);
  // The rounding error of 1 + x.
  const auto lost = hn::Div(hn::Sub(x, hn::Sub(y, one)), y);
  const auto bits = hn::BitCast(d64, y), half = hn::BitCast(d64, number(0.70710678118654752));
  const auto k = hn::ShiftRight<52>(hn::Sub(bits, half));
  const auto f = hn::Sub(hn::BitCast(Tag(), hn::Sub(bits, hn::ShiftLeft<52>(k))), one);
  const auto s = hn::Div(f, hn::Add(number(2), f)), z = hn::Mul(s, s);
  auto series = number(1.0 / 23);
  for (int n = 21; n >= 3; n -= 2) series = hn::Add(hn::Mul(series, z), number(1.0 / n));
  // 2 s (1 + z · series) = f − s f + 2 s z · series
  const auto curved = hn::Mul(s, hn::Sub(f, hn::Mul(hn::Add(z, z), series)));
  const auto power = hn::ConvertTo(Tag(), k);
  const auto small = hn::Add(hn::Sub(lost, curved), hn::Mul(power, number(1.9082149292705877e-10)));
  return hn::Add(hn::Mul(power, number(6.93147180369123816490e-01)), hn::Add(f, small));
}

// Green strain ½ (h + hᵀ + hᵀ h): xx, yy, zz, xy, xz, yz.
HWY_INLINE void green_strain(const Matrix<double>& h, Vector (&e)[6]) {
  constexpr int rows[6] = {0, 1, 2, 0, 0, 1}, cols[6] = {0, 1, 2, 1, 2, 2};
  const auto half = number(0.5);
  for (int k = 0; k < 6; ++k) {
    const int r = rows[k], c = cols[k];
    e[k] = hn::Mul(half, hn::Add(hn::Add(h.at[c][r], h.at[r][c]), dot3(h.at[r], h.at[c])));
  }
}
// The symmetric matrix of these six components.
HWY_INLINE Matrix<double> symmetric(const Vector (&e)[6]) {
  return {{{e[0], e[3], e[4]}, {e[3], e[1], e[5]}, {e[4], e[5], e[2]}}};
}
// Its squared Frobenius norm.
HWY_INLINE Vector square_norm(const Vector (&e)[6]) {
  const auto off_diagonal = dot3(e + 3, e + 3);
  return hn::Add(dot3(e, e), hn::Add(off_diagonal, off_diagonal));
}

HWY_INLINE Matrix<double> cofactor(const Matrix<double>& f) {
  Matrix<double> cof;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) {
      const int c1 = (c + 1) % 3, c2 = (c + 2) % 3, r1 = (r + 1) % 3, r2 = (r + 2) % 3;
      cof.at[c][r] = hn::Sub(hn::Mul(f.at[c1][r1], f.at[c2][r2]), hn::Mul(f.at[c1][r2], f.at[c2][r1]));
    }
  return cof;
}

HWY_INLINE Matrix<double> with_identity(Matrix<double> h) {
  for (int k = 0; k < 3; ++k) h.at[k][k] = hn::Add(h.at[k][k], number(1));
  return h;
}

// Energy density and stress at F = 1 + h, by invariants of the strain without cancellation near
// rigid motions (see energy_density() in elasticity.cpp, whose names this has).
HWY_INLINE Vector elastic(const ElasticConstants& m, const Matrix<double>& h, Matrix<double>& stress) {
  const auto one = number(1), half = number(0.5), two = number(2), four = number(4);
  const auto mu = number(m.mu), lambda = number(m.lambda), volume = number(m.volume);
  const Matrix<double> f = with_identity(h), cof = cofactor(f);
  Vector strain[6];
  green_strain(h, strain);
  const auto e = hn::Add(hn::Add(strain[0], strain[1]), strain[2]), square = square_norm(strain);
  const auto minors = hn::Mul(half, hn::Sub(hn::Mul(e, e), square));
  const auto minor = [&](int a, int b, int c, int d)
                         HWY_ATTR { return hn::Sub(hn::Mul(strain[a], strain[b]), hn::Mul(strain[c], strain[d])); };
  const auto cubic = hn::Add(hn::Sub(hn::Mul(strain[0], minor(1, 2, 5, 5)), hn::Mul(strain[3], minor(3, 2, 5, 4))),
                             hn::Mul(strain[4], minor(3, 5, 1, 4)));
  const auto j = dot3(f.at[0], cof.at[0]);
  const auto positive = hn::Gt(j, hn::Zero(Tag()));
  const auto next = hn::IfThenElse(positive, hn::Add(j, one), one),
             higher = hn::Add(hn::Mul(four, minors), hn::Mul(number(8), cubic));
  const auto volume_strain = hn::IfThenElse(positive, hn::Div(hn::Add(hn::Mul(two, e), higher), next), hn::Sub(j, one));
  const auto remainder =
      hn::IfThenElse(positive, hn::Div(hn::Sub(hn::Mul(e, volume_strain), higher), next), hn::Sub(e, volume_strain));
  const auto bulk = m.neo_hookean ? hn::Add(lambda, volume) : volume;
  auto energy = hn::Mul(hn::Mul(half, bulk), hn::Mul(volume_strain, volume_strain));
  if (m.neo_hookean) {
    const auto x = hn::Mul(half, e), shear = hn::Mul(number(0.75), mu);
    energy =
        hn::Add(energy, hn::Add(hn::Mul(shear, remainder), hn::Mul(hn::Mul(half, mu), hn::Sub(x, log1p_lanes(x)))));
    const auto along = hn::Div(hn::Mul(mu, e), hn::Add(number(8), hn::Mul(four, e))),
               across = hn::Mul(bulk, volume_strain);
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r)
        stress.at[c][r] = hn::Add(hn::Mul(shear, hn::Sub(f.at[c][r], cof.at[c][r])),
                                  hn::Add(hn::Mul(along, f.at[c][r]), hn::Mul(across, cof.at[c][r])));
    return energy;
  }
  energy = hn::Add(energy, hn::Add(hn::Mul(mu, square), hn::Mul(hn::Mul(half, lambda), hn::Mul(e, e))));
  Vector s[6];
  for (int k = 0; k < 6; ++k) {
    s[k] = hn::Mul(hn::Mul(two, mu), strain[k]);
    if (k < 3) s[k] = hn::Add(s[k], hn::Mul(lambda, e));
  }
  stress = product(f, symmetric(s));
  const auto across = hn::Mul(bulk, volume_strain);
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) stress.at[c][r] = hn::Add(stress.at[c][r], hn::Mul(across, cof.at[c][r]));
  return energy;
}

// Dissipation ½ η |Ė|² dt per volume, with Ė from the strain at the start of the step; adds its
// stress.
HWY_INLINE Vector viscous(const ElasticConstants& m, const Matrix<double>& g, const Matrix<double>& previous,
                          Matrix<double>& stress) {
  Vector rate[6], old[6];
  green_strain(g, rate);
  green_strain(previous, old);
  for (int k = 0; k < 6; ++k) rate[k] = hn::Div(hn::Sub(rate[k], old[k]), number(m.dt));
  const Matrix<double> strain_rate_stress = product(with_identity(g), symmetric(rate));
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      stress.at[c][r] = hn::Add(stress.at[c][r], hn::Mul(number(m.viscosity), strain_rate_stress.at[c][r]));
  return hn::Mul(number(0.5 * m.dt * m.viscosity), square_norm(rate));
}

// F times the relaxation (unless null), less the identity.
HWY_INLINE Matrix<double> elastic_part(const double* const* relaxation, std::size_t i, const Matrix<double>& g) {
  if (!relaxation) return g;
  Matrix<double> h = product(with_identity(g), load(relaxation, i));
  for (int k = 0; k < 3; ++k) h.at[k][k] = hn::Sub(h.at[k][k], number(1));
  return h;
}

void Elastic(const ElasticConstants& m, PointRange range, const ElasticArrays& arrays) {
  const auto [volume, relaxation, previous, gradient, energy, elastic_gradient] = arrays;
  const hn::Rebind<float, Tag> d32;
  for (std::size_t i = range.begin; i < range.end; i += width<double>) {
    const Matrix<double> g = load<double>(gradient, i), h = elastic_part(relaxation, i, g);
    Matrix<double> stress;
    if (elastic_gradient)
      for (std::size_t c = 0; c < 3; ++c)
        hn::StoreInterleaved4(hn::DemoteTo(d32, h.at[c][0]), hn::DemoteTo(d32, h.at[c][1]),
                              hn::DemoteTo(d32, h.at[c][2]), hn::Zero(d32), d32, elastic_gradient[c] + 4 * i);
    auto density = elastic(m, h, stress);
    if (relaxation) stress = product(stress, load(relaxation, i));
    if (previous) density = hn::Add(density, viscous(m, g, load(previous, i), stress));
    const auto v = hn::LoadU(Tag(), volume + i);
    const auto has_volume = hn::Gt(v, hn::Zero(Tag()));
    for (auto& column : stress.at)
      for (auto& x : column) x = hn::IfThenElseZero(has_volume, hn::Mul(v, x));
    store(stress, gradient, i);
    hn::StoreU(hn::IfThenElseZero(has_volume, hn::Mul(v, density)), Tag(), energy + i);
  }
}

void Cauchy(const ElasticConstants& m, PointRange range, const double* const* relaxation, const double* const* gradient,
            float* HWY_RESTRICT out) {
  const hn::Rebind<float, Tag> d32;
  constexpr std::size_t lanes = width<double>;
  float numbers[2][4 * lanes];
  for (std::size_t i = range.begin; i < range.end; i += lanes) {
    const Matrix<double> h = elastic_part(relaxation, i, load<double>(gradient, i));
    Matrix<double> piola;
    elastic(m, h, piola);
    const Matrix<double> f = with_identity(h), stress = product(piola, transposed(f));  // J times Cauchy stress
    const auto j = dot3(f.at[0], cofactor(f).at[0]);
    const auto positive = hn::Gt(j, hn::Zero(Tag()));
    const auto number_of = [&](int r, int c) HWY_ATTR {
      return hn::DemoteTo(
          d32,
          hn::IfThenElseZero(positive, hn::Div(hn::Mul(number(0.5), hn::Add(stress.at[c][r], stress.at[r][c])), j)));
    };
    hn::StoreInterleaved4(number_of(0, 0), number_of(1, 1), number_of(2, 2), number_of(0, 1), d32, numbers[0]);
    hn::StoreInterleaved4(number_of(1, 2), number_of(2, 0), hn::DemoteTo(d32, hn::IfThenElseZero(positive, number(1))),
                          hn::Zero(d32), d32, numbers[1]);
    for (std::size_t k = 0; k < lanes; ++k)
      for (std::size_t half = 0; half < 2; ++half) std::copy_n(numbers[half] + 4 * k, 4, out + 8 * (i + k) + 4 * half);
  }
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <array>

namespace geo {
HWY_EXPORT(Elastic);
HWY_EXPORT(Cauchy);
namespace {

// Null pointers if there are no matrices.
std::array<const double*, 3> columns(const PointMatrices<double>* c) {
  return c ? std::array<const double*, 3>{c->column[0].data(), c->column[1].data(), c->column[2].data()}
           : std::array<const double*, 3>{};
}

}  // namespace

ElasticConstants elastic_constants(const Material& m, double dt) {
  // The reparametrised constants of the stable neo-Hookean energy (StableConstants in
  // elasticity.cpp).
  if (m.model == ElasticModel::neo_hookean)
    return {.neo_hookean = true,
            .mu = 4.0 / 3.0 * m.mu(),
            .lambda = m.lambda() + 5.0 / 6.0 * m.mu(),
            .volume = m.volume_term,
            .viscosity = m.viscosity,
            .dt = dt,
            .yields = m.yield > 0};
  return {.neo_hookean = false,
          .mu = m.mu(),
          .lambda = m.lambda(),
          .volume = m.volume_term,
          .viscosity = m.viscosity,
          .dt = dt,
          .yields = m.yield > 0};
}

void elastic_response(const ElasticConstants& constants, PointRange range, const std::vector<double>& volume,
                      const PointHistory& history, PointMatrices<double>& gradient, std::vector<double>& energy,
                      PointMatrices<float>* elastic_gradient) {
  const auto relaxation = columns(history.relaxation), previous = columns(history.previous_gradient);
  double* const stress[3] = {gradient.column[0].data(), gradient.column[1].data(), gradient.column[2].data()};
  float* const elastic[3] = {elastic_gradient ? elastic_gradient->column[0].data() : nullptr,
                             elastic_gradient ? elastic_gradient->column[1].data() : nullptr,
                             elastic_gradient ? elastic_gradient->column[2].data() : nullptr};
  const ElasticArrays arrays{.volume = volume.data(),
                             .relaxation = history.relaxation ? relaxation.data() : nullptr,
                             .previous = history.previous_gradient ? previous.data() : nullptr,
                             .gradient = stress,
                             .energy = energy.data(),
                             .elastic_gradient = elastic_gradient ? elastic : nullptr};
  HWY_DYNAMIC_DISPATCH(Elastic)(constants, range, arrays);
}

void cauchy_stresses(const ElasticConstants& constants, PointRange range, const PointMatrices<double>* relaxation,
                     const PointMatrices<double>& gradient, float* stress) {
  const auto from = columns(&gradient), matrix = columns(relaxation);
  HWY_DYNAMIC_DISPATCH(Cauchy)
  (constants, range, relaxation ? matrix.data() : nullptr, from.data(), stress);
}

}  // namespace geo
#endif
