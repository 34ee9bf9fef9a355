// Strength varies by gradient noise with the material position. The Rayleigh speed is a rational
// fit in Poisson's ratio; toughness becomes a stress by the line method (see strength.h).
#include "simulation/strength.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "crack/noise.h"

namespace geo {

namespace {
// Where noise · variation is near −1 or below, the strength would be zero or negative, and any
// stress would start a crack. The weakest places keep a twentieth instead.
constexpr double least_factor = 0.05;
}  // namespace

double strength_factor(const Strength& s, std::uint64_t seed, double diagonal, const Vec3& x) {
  if (s.variation == 0) return 1;
  return std::max(least_factor, 1 + s.variation * gradient_noise(x / (s.grain > 0 ? s.grain : 0.1 * diagonal), seed));
}

bool may_break(const FractureOptions& f, const Vec3& x) {
  return std::none_of(f.off.begin(), f.off.end(), [&](const auto& b) {
    return (x.array() >= b[0].array()).all() && (x.array() <= b[1].array()).all();
  });
}

double rayleigh_speed(const Material& m) {
  return std::sqrt(m.mu() / m.density) * (0.862 + 1.14 * m.poisson) / (1 + m.poisson);
}

double pressure_wave_speed(const Material& m) { return std::sqrt((m.lambda() + 2 * m.mu()) / m.density); }

double stress_of_toughness(double toughness, double h) { return toughness * std::sqrt(2 / (std::numbers::pi * h)); }

}  // namespace geo
