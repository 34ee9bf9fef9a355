// Nearest nodes in vector lanes, for nearest.cpp.
#pragma once

#include <functional>
#include <span>

#include "graph/node_tree.h"
#include "kerf/vec.h"

namespace geo {

/// visit_nearest() for the nodes of some cells (`groups`), with the widest vectors of the
/// processor.
void nearest_of_groups(const NodeTree& tree, std::span<const std::uint32_t> groups, std::uint32_t k,
                       const std::function<void(NodeId, std::span<const NodeId>)>& visit);

}  // namespace geo
