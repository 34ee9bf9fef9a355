// Scores that do not go all the way (§ 7): bodies hold until they break.
#pragma once

#include "geometry/bvh.h"
#include "kerf/mesh.h"

namespace geo {

/// Leaves of each wall, as far as it is in one place in the material, what is less deep under the
/// skin than that fraction of its greatest depth: a ligament in the middle stays whole. Triangles
/// are cut along that depth, where walls meet in the same points. Walls end where others meet them.
/// `depth` is in (0, 1); throws InputError when it is not.
void keep_shallow(TriangleMesh& walls, const TriangleBvh& skin, double depth);

}  // namespace geo
