// After a motion in which some were carried: each vertex for itself comes nearer to where it wants
// to be.
#pragma once

#include "kerf/mesh.h"

namespace geo {

/// Moves rows of `at`, where no two triangles (of rows that stand for others) cross, towards `to`:
/// straight on where nothing is in the way (straight_motion.h), then as far as planes between near
/// parts let them go (separating_planes.h), a tenth of an edge at most. `edge` and `gap`, that
/// sheets in contact keep: model units. Returns the number of planes.
std::size_t advance_vertices(const std::vector<Triangle>& triangles, const std::vector<Vec3>& to, double edge,
                             double gap, std::vector<Vec3>& at);

}  // namespace geo
