// Convex bodies that stand for a piece in a physics engine.
#pragma once

#include <cstddef>
#include <vector>

#include "surface/triangle_mesh.h"

namespace geo {

/// The convex hulls, of `corners` corners at most each, of at most `parts` parts of a closed mesh. Parts are made by planes across
/// the principal axes of what is divided, the one first that saves most volume of hulls (after Mamou and Ghorbel 2009), while that
/// is more than a hundredth of the whole hull's. Hulls of all their corners cover the mesh. None where it lies in one plane.
std::vector<TriangleMesh> convex_parts(const TriangleMesh& mesh, std::size_t parts, std::size_t corners);

}  // namespace geo
