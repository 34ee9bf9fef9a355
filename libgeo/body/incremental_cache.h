// Derived data of a body that each step updates, so that its cost follows the cut.
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "kerf/body.h"
#include "sampling/node_grid.h"

namespace geo {

/// See Body::cache. build_body() and read_body() fill the grid, prepare_cache() the rest.
///
/// A piece without a node is a sliver of material too thin for a node in double precision. A shell
/// is unseen when none of its vertices is the closest visible one of any node.
struct IncrementalCache {
  NodeGrid grid;                                ///< over nodes.position
  std::vector<std::int32_t> piece;              ///< by surface vertex: the label of its piece of material; −1: dead
  std::int32_t piece_count = 0;                 ///< labels in use are below this
  std::set<std::int32_t> pieces_without_node;   ///< labels, as far as known
  bool inner_shells = false;                    ///< several shells may bound one piece: cavities, internal cracks
  std::vector<std::uint32_t> depth;             ///< by surface vertex: depth under its master; ~0u: orphans
  std::vector<SurfaceVertexId> unseen_masters;  ///< masters of unseen shells, ascending
};

/// Derives piece labels, depths and unseen masters where they are missing: in a body just built or
/// read. Costs one pass over the surface.
void prepare_cache(Body& body);

}  // namespace geo
