// On which side of each other's planes and edges triangles lie, as a quick look at which cannot
// cross.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Leaves those pairs of triangles of which this look cannot tell that they have no more in common
/// than corners and edges, in their order: neither has all its corners, but those that it shares
/// with the other, strictly on one side of the other's plane; nor, seen along the axis that the
/// first faces most, strictly beyond one of the other's edges, but for corners shared on it. Signs
/// as sure as those of orient3d_filtered() and orient2d_filtered(). Two triangles with the same
/// three corners are kept. `triangles`: of rows that stand for others.
void keep_unclear(std::span<const Triangle> triangles, const std::vector<Vec3>& positions,
                  std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs);

}  // namespace geo
