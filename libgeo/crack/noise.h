// Gradient noise for jagged cracks, jagged scores and random strength.
#pragma once

#include <cstdint>

#include "kerf/vec.h"

namespace geo {

/// Gradient noise (Perlin 2002) at p: about [−1, 1], zero at lattice points, of unit lattice
/// spacing. It depends on p and the seed alone.
double gradient_noise(const Vec3& p, std::uint64_t seed);

}  // namespace geo
