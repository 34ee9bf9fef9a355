// The part of a blade's edge that is about in the material, and the front that it leaves (§ 5.1).
#pragma once

#include <span>
#include <vector>

#include "kerf/crack.h"
#include "kerf/run.h"

namespace geo {

/// A point of an edge that was mapped into the material.
struct EdgePoint {
  double at = 0;
  Vec3 material;
  double spacing = 0;  ///< of the nodes there
};

/// Where a front begins. At least two points.
EdgeFront begin_edge(std::span<const EdgePoint> points, std::int32_t crack, const std::string& name,
                     bool closed = false);

/// The same front, with the points that `next` has and it lacks (upsampling: each begins where its
/// neighbour on the edge is), and where every point goes; those that `next` lacks go where their
/// nearest neighbour does (downsampling).
EdgeFront refined(const EdgeFront& edge, std::span<const EdgePoint> next, std::vector<Vec3>& to);
/// After that step: takes out the points that `next` lacks, unless the step kept them apart.
void collapse(EdgeFront& edge, std::span<const EdgePoint> next);

/// The part of a front between two places on the edge; of fewer than two points: none.
EdgeFront part_of(const EdgeFront& edge, double from, double to);
/// One front of two that follow each other on the edge.
EdgeFront joined(EdgeFront a, const EdgeFront& b);

}  // namespace geo
