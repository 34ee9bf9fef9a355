// Reduces the tracking error that a fallback motion or a first guess has left: each vertex alone
// approaches its target.
#pragma once

#include "kerf/mesh.h"

namespace geo {

/// Moves the vertices `at`, of which no two triangles cross, towards `to`: straight where nothing
/// is in the way (straight_motion.h), then within separating planes (separating_planes.h), there at
/// most a tenth of an edge. `triangles`: of representatives. `edge`: mean edge; `gap`: distance
/// that surfaces in contact keep; model units. Returns the number of separating planes.
std::size_t advance_vertices(const std::vector<Triangle>& triangles, const std::vector<Vec3>& to, double edge,
                             double gap, std::vector<Vec3>& at);

/// The first half of advance_vertices(): straight motion alone, so that vertices with something in
/// the way keep what holds them. Same arguments.
void advance_free_vertices(const std::vector<Triangle>& triangles, const std::vector<Vec3>& to, double edge, double gap,
                           std::vector<Vec3>& at);

}  // namespace geo
