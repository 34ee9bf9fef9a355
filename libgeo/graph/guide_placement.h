// Where guides stand (§ 8): beside the concave edges of a surface, where shortest paths bend.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "graph/guide_set.h"
#include "kerf/nodes.h"
#include "sampling/node_grid.h"

namespace geo {

/// An edge ab of the surface between triangles abc and bad, which face outwards. At the front of a
/// crack they are the two sides of one face.
struct SurfaceEdge {
  Vec3 a, b, c, d;
};

struct GuideOptions {
  double spacing = 0.5;  ///< between guides along an edge, in spacings of the nodes there; from 0.05 to 10
  double bend =
      20;  ///< edges get guides where the material spans at least so much more than 180 degrees; from 1 to 180
};

/// Points just inside the material along those of the edges that are concave, and along the fronts
/// of cracks: the middles of equal parts of each edge, but none that sees one placed before, or one
/// of `taken`, close by. `grid` holds all nodes, of which there is one at least: a guide takes the
/// support radius of the nearest. `blocked`: whether a face touches the segment between two points.
/// Throws InputError when an option is out of range.
std::vector<Guide> place_guides(std::span<const SurfaceEdge> edges, const NodeSet& nodes, const NodeGrid& grid,
                                const std::function<bool(const Vec3&, const Vec3&)>& blocked,
                                const GuideOptions& options = {}, const GuideSet& taken = {});

}  // namespace geo
