// The nodes nearest to each node (§ 6.1).
#pragma once

#include <span>
#include <vector>

#include "base/ids.h"
#include "base/vec.h"

namespace geo {

/// The k nearest nodes of each node (fewer when there are fewer), by (distance, id), without itself. Row i at [i·k].
/// Missing entries are invalid ids.
std::vector<NodeId> nearest_nodes(std::span<const Vec3> positions, int k);

/// The edge of a grid cell that holds about one node and a half, model units.
double grid_cell_for(std::span<const Vec3> positions);

}  // namespace geo
