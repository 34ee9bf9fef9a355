// Neighbours of nodes (§ 6.2): everything within the support radius along the visibility graph.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "graph/visibility_graph.h"

namespace geo {

enum class NeighborMethod { automatic, dijkstra, mfw };

struct Neighbor {
  NodeId to;
  std::uint32_t warped = 0;  ///< graph distance in 2⁻²⁴ support radii, < unit_radius: decides membership (§ 6.4)
  float distance = 0;        ///< what weights use, model units: Euclidean where the pair sees each other, else the path's
  friend bool operator==(const Neighbor&, const Neighbor&) = default;
};

/// One row a node, sorted by node id, without the node itself. Symmetric: j is in row i exactly when i is in row j.
struct Neighborhoods {
  std::vector<std::vector<Neighbor>> rows;
  std::span<const Neighbor> of(NodeId i) const { return rows[i.index()]; }
  friend bool operator==(const Neighborhoods&, const Neighborhoods&) = default;
};

/// All rows from scratch. `mfw` is the paper's modified Floyd-Warshall, `dijkstra` a plain bounded one, `automatic` the
/// fastest we have; all give the same rows, bit for bit, for any number of threads.
Neighborhoods build_neighborhoods(const NodeSet& nodes, const VisibilityGraph& graph, const TriangleBvh& obstacles,
                                  NeighborMethod method = NeighborMethod::automatic, const Progress& progress = {});

/// One node's row, by a search truncated at the support radius; `blocked` tells whether a face touches the segment
/// between two nodes. Safe to call from several threads.
std::vector<Neighbor> neighborhood_of(NodeId i, const NodeSet& nodes, const VisibilityGraph& graph,
                                      const std::function<bool(NodeId, NodeId)>& blocked);

}  // namespace geo
