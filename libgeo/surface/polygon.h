// Polygons as triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// The polygon whose corners are these rows of `vertices`, at least three, as n − 2 triangles of
/// its corners 0 … n − 1: a fan from corner 0 where all of it turns the polygon's way (exactly,
/// seen along the axis that the polygon faces most), else ears, cut off one after another. A
/// polygon that crosses itself, or has no area, is a fan in any case.
std::vector<std::array<std::uint32_t, 3>> triangles_of(const std::vector<Vec3>& vertices,
                                                       const std::vector<std::uint32_t>& polygon);

}  // namespace geo
