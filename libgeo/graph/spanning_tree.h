// The Euclidean minimum spanning tree (§ 6.1), which keeps the graph in one piece before faces cut it.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "graph/node_tree.h"
#include "kerf/vec.h"

namespace geo {

/// Edges (i < j) of the Euclidean minimum spanning tree, ascending. Exact; among edges of the same squared length (of
/// doubles) the one with the lower nodes counts as shorter, so there is one answer.
std::vector<std::pair<NodeId, NodeId>> spanning_tree(std::span<const Vec3> positions);

/// Those of its edges that join no node with one of its k nearest: what the tree adds to the graph of these, which is
/// nothing where nodes are spread evenly. `near`: nearest_nodes(tree, k).
std::vector<std::pair<NodeId, NodeId>> spanning_tree_beyond(const NodeTree& tree, std::span<const Vec3> positions,
                                                            std::span<const NodeId> near, int k);

}  // namespace geo
