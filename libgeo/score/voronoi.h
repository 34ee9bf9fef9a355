// Walls of Voronoi cells; adjacent walls share vertices exactly.
#pragma once

#include <functional>
#include <span>

#include "kerf/mesh.h"

namespace geo {

/// The walls between the Voronoi cells of the sites, clipped to the box: convex polygons as
/// triangles. A vertex is identified by the sites and box sides that define it, so that all walls
/// at it share its index. Sites in degenerate position (more than four cells meet in a point) are
/// displaced slightly. Throws InputError for fewer than two sites, sites outside the box, or two
/// equal ones; GeometryError where displacements do not help. `pause` is called for each site, and
/// may throw.
TriangleMesh voronoi_walls(std::span<const Vec3> sites, const Box3& box, const std::function<void()>& pause = {});

}  // namespace geo
