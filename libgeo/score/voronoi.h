// Voronoi cells, their walls shared to the bit.
#pragma once

#include <span>

#include "kerf/mesh.h"

namespace geo {

/// The walls between the Voronoi cells of the sites, as far as the box reaches: convex polygons as
/// triangles. A corner is named by the sites and sides of the box that make it, so that all walls
/// at it share its row. Sites that stand too regularly for that (more than four cells meet in a
/// point) are moved a little. Throws InputError for fewer than two sites, sites outside of the box,
/// or two at one place.
TriangleMesh voronoi_walls(std::span<const Vec3> sites, const Box3& box);

}  // namespace geo
