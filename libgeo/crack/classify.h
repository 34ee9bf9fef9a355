// Classifies the strip's children as inside or outside the material (the trimming of § 5.2).
#pragma once

#include <cstdint>
#include <vector>

#include "crack/edge_table.h"

namespace geo::crack {

/// A child of the strip.
struct ChildRef {
  std::uint32_t element, child;  ///< indices of an element of the arrangement and of its child
};

/// The strip's children that lie in the material and on no face, in order of children. A child with
/// an edge on K is decided by the wedge of K in which it lies; flood fill decides its neighbours; a
/// component without such an edge is decided by ray parity against the skin. Throws GeometryError
/// when a child lies on a face at an edge, when two edges of a component disagree, and as
/// inside_material().
std::vector<ChildRef> children_in_material(const Arrangement& arrangement, const Complex& complex,
                                           const EdgeTable& edges);

/// True when q is in the material (neither in a cavity nor outside). Exact ray parity, through the
/// spatial index. Throws GeometryError when 24 rays all touch an edge of the skin.
bool inside_material(const Complex& complex, const Vec3& q);

}  // namespace geo::crack
