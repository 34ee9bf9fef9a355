// The Euclidean minimum spanning tree (§ 6.1), which keeps the graph in one piece before faces cut it.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "base/ids.h"
#include "base/vec.h"

namespace geo {

/// Edges (i < j) of the Euclidean minimum spanning tree, ascending.
std::vector<std::pair<NodeId, NodeId>> spanning_tree(std::span<const Vec3> positions);

}  // namespace geo
