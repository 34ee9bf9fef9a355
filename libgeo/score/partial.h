// Partial scores (§ 7): ligaments hold a body together until they break.
#pragma once

#include "geometry/bvh.h"
#include "kerf/mesh.h"

namespace geo {

/// Cuts the middle out of each connected part of a wall inside the material: kept is only
/// d(x) < depth · max d, d: distance to the skin. A ligament of material stays whole there.
/// Triangles are cut along that depth; walls that meet are cut at the same points. A wall ends
/// where others meet it. Throws InputError unless depth is in (0, 1).
void keep_shallow(TriangleMesh& walls, const TriangleBvh& skin, double depth);

}  // namespace geo
