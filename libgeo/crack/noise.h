// Gradient noise for jagged cracks, jagged scores and random strength.
#pragma once

#include <array>
#include <cstdint>

#include "kerf/vec.h"

namespace geo {

/// Gradient noise (Perlin 2002) at p: about [−1, 1], zero at lattice points, of unit lattice
/// spacing. It depends on p and the seed alone.
double gradient_noise(const Vec3& p, std::uint64_t seed);
/// gradient_noise() of three seeds at one point, at less than three times the cost.
std::array<double, 3> gradient_noises(const Vec3& p, const std::array<std::uint64_t, 3>& seeds);

}  // namespace geo
