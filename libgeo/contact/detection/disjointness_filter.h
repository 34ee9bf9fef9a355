// A filter for triangle pairs that certainly do not cross, in SIMD lanes.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Removes the pairs of triangles that certainly have no more in common than shared vertices and
/// edges. The others stay in order. A pair is removed in two cases. First, the vertices of one
/// triangle that the other does not have lie strictly on one side of the other's plane. Second,
/// in the projection along the axis that the first triangle faces most, one triangle lies
/// strictly beyond an edge of the other, except for vertices shared on that edge. Signs have the
/// error bounds of orient3d_filtered() and orient2d_filtered(). Pairs with the same three
/// vertices are kept. `triangles`: of representatives (coincident_representatives()).
void remove_disjoint(std::span<const Triangle> triangles, const std::vector<Vec3>& positions,
                     std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs);

}  // namespace geo
