// The nodes nearest to each node (§ 6.1).
#pragma once

#include <functional>
#include <span>

#include "base/uninitialized_array.h"
#include "graph/node_tree.h"
#include "kerf/vec.h"

namespace geo {

/// The k nearest nodes of each node (fewer when there are fewer), by (distance, id), without itself. Row i at [i·k].
/// Missing entries are invalid ids. Exact: by squared_distance(), then id.
UninitializedArray<NodeId> nearest_nodes(std::span<const Vec3> positions, int k);
UninitializedArray<NodeId> nearest_nodes(const NodeTree& tree, int k);

/// The same, a row at a time and none of them kept: `take(i, row)` is called once for each node, in no set order and
/// from several threads; the row is gone after the call.
void visit_nearest(const NodeTree& tree, int k, const std::function<void(NodeId, std::span<const NodeId>)>& take);

}  // namespace geo
