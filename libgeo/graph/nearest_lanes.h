// Nearest nodes in vector lanes: what nearest.cpp calls.
#pragma once

#include <functional>
#include <span>

#include "graph/node_tree.h"
#include "kerf/vec.h"

namespace geo {

/// visit_nearest() for the nodes of some cells, by the widest vectors that the processor has.
void nearest_of_groups(const NodeTree& tree, std::span<const std::uint32_t> groups, std::uint32_t k,
                       const std::function<void(NodeId, std::span<const NodeId>)>& take);

}  // namespace geo
