// The Euclidean minimum spanning tree (§ 6.1): it keeps the graph connected before faces cut it.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "graph/node_tree.h"
#include "kerf/vec.h"

namespace geo {

/// Edges (i < j) of the Euclidean minimum spanning tree, ascending. Exact; edges are ordered by
/// (squared_distance(), i, j), so the tree is unique.
std::vector<std::pair<NodeId, NodeId>> spanning_tree(std::span<const Vec3> positions);

/// The tree's edges that the graph of k nearest nodes lacks, ascending. Where nodes are spread
/// evenly, there is none as a rule. `near`: nearest_nodes(tree, k).
std::vector<std::pair<NodeId, NodeId>> spanning_tree_beyond(const NodeTree& tree, std::span<const Vec3> positions,
                                                            std::span<const NodeId> near, int k);

}  // namespace geo
