// Triangulates polygons in space.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Triangulates a polygon, given by indices of at least three vertices, into n − 2 triangles of its
/// corners 0 … n − 1: a fan from corner 0 where all its triangles have the polygon's orientation
/// (exactly, projected along the dominant axis of its normal), else by ear clipping. A polygon that
/// crosses itself, or has no area, gives the fan.
std::vector<std::array<std::uint32_t, 3>> triangles_of(const std::vector<Vec3>& vertices,
                                                       const std::vector<std::uint32_t>& polygon);

}  // namespace geo
