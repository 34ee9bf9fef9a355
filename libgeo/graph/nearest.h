// The k nearest nodes of each node (§ 6.1).
#pragma once

#include <functional>
#include <span>

#include "base/uninitialized_array.h"
#include "graph/node_tree.h"
#include "kerf/vec.h"

namespace geo {

/// The k nearest nodes of each node, without itself, ascending by squared_distance(), then id.
/// Exact. Row i begins at [i·k]; missing entries are invalid ids. Throws InputError for a negative
/// k.
UninitializedArray<NodeId> nearest_nodes(std::span<const Vec3> positions, int k);
/// The same over a tree that exists.
UninitializedArray<NodeId> nearest_nodes(const NodeTree& tree, int k);

/// The same without storing them: calls visit(i, nearest) once for each node, in no fixed order and
/// from several threads. `nearest` is valid during the call.
void visit_nearest(const NodeTree& tree, int k, const std::function<void(NodeId, std::span<const NodeId>)>& visit);

}  // namespace geo
