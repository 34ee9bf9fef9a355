// Positions of guides (§ 8): beside the concave edges of a surface, where shortest paths bend.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "graph/guide_set.h"
#include "kerf/nodes.h"
#include "sampling/node_grid.h"

namespace geo {

/// An edge ab of the surface between triangles abc and bad, which face outwards. At a crack front
/// the two triangles are the two sides of one face.
struct SurfaceEdge {
  Vec3 a, b, c, d;
};

/// Options of place_guides().
struct GuideOptions {
  /// Between guides along an edge, in spacings of the nodes there; 0.05 to 10. At 0.5, lengths of
  /// paths around a crack are 2.3 % too long on average, without guides 42 % (docs/decisions/028).
  double spacing = 0.5;
  double bend = 20;  ///< least angle by which the material around an edge exceeds 180 degrees; 1 to 180
};

/// Guides just inside the material along edges that are concave or crack fronts. Each such edge is
/// divided into equal parts no longer than `spacing`, and a guide stands beside the middle of each
/// part. It is left out if it sees an earlier guide, or one of `taken`, within half of `spacing`.
/// Guides take the support radius of the nearest node. `grid` is over all nodes, of which there is
/// at least one. `blocked`: does a face touch the segment between two points? Throws InputError for
/// options out of range.
std::vector<Guide> place_guides(std::span<const SurfaceEdge> edges, const NodeSet& nodes, const NodeGrid& grid,
                                const std::function<bool(const Vec3&, const Vec3&)>& blocked,
                                const GuideOptions& options = {}, const GuideSet& taken = {});

}  // namespace geo
