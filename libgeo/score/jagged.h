// Jagged walls: refined triangles, displaced by noise that depends on the position alone, so that
// walls that meet stay together.
#pragma once

#include <functional>

#include "geometry/bvh.h"
#include "kerf/mesh.h"
#include "kerf/score.h"

namespace geo {

/// Bisects edges, the longest first, until those in or near the material are at most `longest`
/// long; drops triangles farther outside the skin than `margin`. Model units. Calls `pause` between
/// its stages, in the calling thread, which may throw; none where it is empty.
void refine_walls(TriangleMesh& walls, const TriangleBvh& skin, double longest, double margin,
                  const std::function<void()>& pause = {});

/// Refines walls and displaces their vertices by fractal noise, finer near the skin where there is
/// detail at edges. Vertices move less, or not at all,
/// where walls would cross: walls that meet in shared vertices and edges alone still do. Throws
/// InputError for options out of range. `pause` as in refine_walls().
void roughen_walls(TriangleMesh& walls, const TriangleBvh& skin, const JaggedOptions& options,
                   const std::function<void()>& pause = {});

}  // namespace geo
