// A run as USD (Universal Scene Description, text form): what film and game pipelines read.
#pragma once

#include <functional>
#include <ostream>

#include "surface/triangle_mesh.h"

namespace geo {

/// Frames of one rate. Each is asked for once, those with new triangles several times where they are many, from any threads; one a thread is in memory,
/// and one more, and the triangles of the first few with new ones.
struct UsdRun {
  std::size_t frames = 0;
  double frame_rate = 24;  ///< frames a second
  char up = 'Z';           ///< the axis that is up: 'Y' or 'Z', as USD knows no other
  std::function<TriangleMesh(std::size_t)> surface;    ///< of the bodies, in metres; its rows may be others in each frame
  std::function<TriangleMesh(std::size_t)> obstacles;  ///< triangles alike in all frames; none: there are no obstacles
};

/// Mesh /run/body with a time sample of points a frame, and of what its triangles are where they change; texture coordinates, where
/// the surface has them; triangles of the skin and those of cracks as subsets bound to materials of their own, and each triangle's
/// crack as primvars:patch. Mesh /run/obstacles.
void write_usda(std::ostream& out, const UsdRun& run);

}  // namespace geo
