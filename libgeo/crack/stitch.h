// Turns an arrangement into an edit of K (§ 5.2: joins crack and skin along their seam).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "crack/classify.h"

namespace geo::crack {

/// The edit that divides the faces of K as the arrangement says and adds the strip's children
/// `kept` as faces of crack `crack`. It gives the radial order around each edge that a crack face
/// joins or that was divided and has three or more faces. `vertex` receives the vertex of each
/// point in use. `edges`: edges_of_complex(arrangement), the faces of K without the strip. `kept`:
/// see children_in_material(). Throws GeometryError when two faces coincide at an edge, or when the
/// arrangement lacks a face around an edge of K that it divides or joins.
ComplexEdit stitch(const Arrangement& arrangement, const Complex& complex, const EdgeTable& edges,
                   std::span<const ChildRef> kept, std::int32_t crack, std::vector<VertexId>& vertex);

}  // namespace geo::crack
