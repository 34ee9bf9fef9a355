// A filter for triangle pairs that certainly do not cross, in SIMD lanes.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Removes the pairs of triangles that provably do not cross (kerf/contact.h): pairs that are
/// disjoint, and pairs that touch in shared vertices and edges only. The others stay in order.
/// A pair is removed in two cases. First, the unshared vertices of one triangle lie strictly on one
/// side of the other's plane. Second, one triangle lies strictly beyond an edge of the other,
/// except for vertices shared on that edge; this in the projection along the dominant axis of the
/// first triangle's normal. Signs have the error bounds of orient3d_filtered() and
/// orient2d_filtered(). Pairs with the same three vertices are kept. `triangles`: all triangles,
/// with each vertex replaced by its representative (coincident_representatives()).
void remove_disjoint(std::span<const Triangle> triangles, const std::vector<Vec3>& positions,
                     std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs);

}  // namespace geo
