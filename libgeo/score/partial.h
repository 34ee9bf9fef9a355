// Partial scores (§ 7): ligaments hold a body together until they break.
#pragma once

#include "geometry/bvh.h"
#include "kerf/mesh.h"

namespace geo {

/// Keeps each connected part of a wall inside the material only where it is less deep under the
/// skin than the fraction `depth` of its greatest depth: a ligament in the middle stays whole.
/// Triangles are cut along that depth; walls that meet are cut at the same points. A wall ends
/// where others meet it. Throws InputError unless depth is in (0, 1).
void keep_shallow(TriangleMesh& walls, const TriangleBvh& skin, double depth);

}  // namespace geo
