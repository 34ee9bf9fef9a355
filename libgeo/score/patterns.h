// Generates the walls of a fracture pattern (§ 7), which divide space into a given number of cells,
// approximately.
#pragma once

#include <vector>

#include "geometry/bvh.h"
#include "kerf/mesh.h"
#include "kerf/score.h"

namespace geo {

/// Walls of the pattern in a box that contains the model and is wider by half its diagonal. About
/// `cells` cells contain part of the model (patterns sheets and curves: as given). Throws
/// InputError for options that make no walls.
TriangleMesh pattern_walls(const TriangleBvh& skin, int cells, const PatternOptions& options);

/// Blue-noise points inside the skin by best-candidate sampling with ten candidates (Mitchell
/// 1991), denser near the impact, if any. Distances are measured after `stretch`; the points
/// returned are stretched. A larger count only appends points.
std::vector<Vec3> sample_sites(const TriangleBvh& skin, int count, const Mat3& stretch, const PatternOptions& options);

}  // namespace geo
