// Where guides stand (§ 8): beside the concave edges of a surface, where shortest paths bend.
#pragma once

#include <vector>

#include "geometry/bvh.h"
#include "graph/guide_set.h"
#include "sampling/node_grid.h"
#include "sampling/node_set.h"
#include "surface/triangle_mesh.h"

namespace geo {

struct GuideOptions {
  double spacing = 0.5;  ///< between guides along an edge, in spacings of the nodes there; from 0.05 to 10
  double bend = 20;      ///< edges get guides where the material spans at least so much more than 180 degrees; from 1 to 180
};

/// Points just inside the material along the concave edges of an oriented surface, and along the fronts of its cracks
/// (edges of two triangles that lie on each other): the middles of equal parts of each edge, but none close to one before
/// that it sees. Only edges between two triangles count. `grid` holds all nodes, of which there is one at least: a guide
/// takes the support radius of the nearest. Throws InputError when an option is out of range.
std::vector<Guide> place_guides(const TriangleMesh& surface, const NodeSet& nodes, const NodeGrid& grid, const TriangleBvh& obstacles,
                                const GuideOptions& options = {});

}  // namespace geo
