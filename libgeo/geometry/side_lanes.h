// On which side of a triangle's plane points are, many at once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "kerf/vec.h"

namespace geo {

/// A bit a point, 64 a word, for `words` words: above where orient3d() of the triangle and the point is clearly 1,
/// below where it is clearly −1; neither where only exact arithmetic could say. `at`: x, y and z of the points.
void clear_sides(const std::array<Vec3, 3>& triangle, const double* const* at, std::size_t words, std::uint64_t* above,
                 std::uint64_t* below);

}  // namespace geo
