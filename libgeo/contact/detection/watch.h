// Parts of triangles that may come together in a step, each with a plane's normal that parts them where the step
// begins.
//
// Two convex parts that one direction parts at the beginning and at the end of a straight motion do not meet during it:
// the plane between them may move along. So no root of a cubic is looked for, and motion in a plane is no special case.
// Triangles that share corners are taken to parts without them: an edge against a triangle, a corner against a
// triangle.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "contact/detection/near_pairs.h"
#include "contact/detection/simplex.h"
#include "contact/detection/surface_motion.h"

namespace geo {

struct Watched {
  Simplex a, b;           ///< rows of vertices; none in both, nor two together
  Vec3 normal;            ///< unit; from b to a
  ClosestPlaces closest;  ///< where it begins
  double gap;             ///< least distance along the normal that the step may leave, model units
};

/// Pairs that share no corner. Where the plane of a pair comes closest to what the motion wants, it is the one taken.
/// Which they are depends on the motion alone, their order on what `near` was used for before, too. `owner` (per row,
/// or empty): of the pairs of triangles between the surroundings of the same two owners no more than `most` (at least
/// 1), by the planes of the triangles those that the motion brings closest. `near`: is left with the pairs that may
/// come together.
std::vector<Watched> watch(const SurfaceMotion& motion, NearPairs& near, std::span<const std::uint32_t> owner = {},
                           std::size_t most = 0);

}  // namespace geo
