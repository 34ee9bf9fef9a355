// The filter of orient3d() for one triangle and many points, in SIMD lanes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "kerf/vec.h"

namespace geo {

/// Filtered orientations of 64 · words points about a triangle, one bit a point: a bit of `above`
/// is set if orient3d() is certainly 1, of `below` if it is certainly −1. Neither is set where
/// the filter cannot decide. `coordinates`: the arrays of x, y and z.
void filtered_orientations(const std::array<Vec3, 3>& triangle, const double* const* coordinates, std::size_t words,
                           std::uint64_t* above, std::uint64_t* below);

}  // namespace geo
