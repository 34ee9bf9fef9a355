// Parts of triangles that may come together in a step, each with a plane's normal that parts them where the step begins.
//
// Two convex parts that one direction parts at the beginning and at the end of a straight motion do not meet during it: the
// plane between them may move along. So no root of a cubic is looked for, and motion in a plane is no special case. Triangles
// that share corners are taken to parts without them: an edge against a triangle, a corner against a triangle.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "contact/simplex.h"

namespace geo {

struct Watched {
  Simplex a, b;   ///< rows of vertices; none in both, nor two together
  Vec3 normal;    ///< unit; from b to a
  ClosestPlaces closest;  ///< where it begins
  double gap;     ///< least distance along the normal that the step may leave, model units
};

/// What a step is about: triangles of rows, for each row the one that stands for it (vertices_together()), and where all are at
/// its beginning, where no two triangles cross, and want to be at its end.
struct SurfaceMotion {
  const std::vector<Triangle>& triangles;
  std::span<const std::uint32_t> together;
  const std::vector<Vec3>&from, &to;
  double gap = 0;    ///< that sheets in contact keep
  double reach = 0;  ///< pairs that come closer than this are watched
};

/// Pairs that share no corner. Where the plane of a pair comes closest to what the motion wants, it is the one taken. In an order
/// that depends on the motion alone. `owner` (per row, or empty): of the pairs of triangles between the surroundings of the same
/// two owners no more than `most`, by the planes of the triangles those that the motion brings closest.
std::vector<Watched> watch(const SurfaceMotion& motion, std::span<const std::uint32_t> owner = {}, std::size_t most = 0);

}  // namespace geo
