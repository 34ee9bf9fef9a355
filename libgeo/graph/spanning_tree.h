// The Euclidean minimum spanning tree (§ 6.1): it keeps the graph connected before faces cut it.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "graph/node_tree.h"
#include "kerf/vec.h"

namespace geo {

/// Edges (i < j) of the Euclidean minimum spanning tree, ascending. Exact; among edges of equal
/// squared_distance() the one with the lower nodes counts as shorter, so the tree is unique.
std::vector<std::pair<NodeId, NodeId>> spanning_tree(std::span<const Vec3> positions);

/// The tree's edges that join no node to one of its k nearest: those that the tree adds to the
/// graph of nearest nodes. As a rule none, where nodes are spread evenly. `near`:
/// nearest_nodes(tree, k).
std::vector<std::pair<NodeId, NodeId>> spanning_tree_beyond(const NodeTree& tree, std::span<const Vec3> positions,
                                                            std::span<const NodeId> near, int k);

}  // namespace geo
