// Generates the walls of a fracture pattern (§ 7), which divide space into a given number of cells,
// approximately.
#pragma once

#include <functional>
#include <vector>

#include "geometry/bvh.h"
#include "kerf/mesh.h"
#include "kerf/score.h"

namespace geo {

/// Walls of the pattern in a box that contains the model and is wider by half its diagonal. About
/// `cells` cells contain part of the model (patterns sheets and curves: as given). Throws
/// InputError for options that make no walls. `pause` is called now and then, and may throw.
TriangleMesh pattern_walls(const TriangleBvh& skin, int cells, const PatternOptions& options,
                           const std::function<void()>& pause = {});

/// The density divided by its largest value among 4096 random points inside the skin, and at most
/// 1; a place with more than that, smaller than a 4096th of the volume, may be missed. Empty for an
/// empty density. Throws InputError where the density is 0 at all of them, and, at each point where
/// it is called, for a value below 0 or not finite.
Density relative_density(const TriangleBvh& skin, const Density& density);

/// Blue-noise points inside the skin by best-candidate sampling with ten candidates (Mitchell
/// 1991), denser near the impact, if any, and where `density`, which is at most 1, is high.
/// Distances are measured after `stretch`; the points returned are stretched. A larger count only
/// appends points. `pause` is called before each candidate of a site, and may throw.
std::vector<Vec3> sample_sites(const TriangleBvh& skin, int count, const Mat3& stretch, const PatternOptions& options,
                               const std::function<void()>& pause = {});

}  // namespace geo
