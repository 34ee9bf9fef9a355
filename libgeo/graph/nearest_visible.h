// The nodes that new ones get edges to (§ 6.4).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "kerf/nodes.h"
#include "kerf/progress.h"
#include "sampling/node_grid.h"

namespace geo {

/// For each of `ids` the k nearest nodes that it sees, nearest first, or those of its 3 k nearest.
/// `grid` holds all nodes; `obstacle_near` appends the triangles whose boxes meet a box, and is
/// asked from several threads.
std::vector<std::vector<std::uint32_t>> nearest_visible(
    const NodeSet& nodes, const NodeGrid& grid, std::span<const std::uint32_t> ids, int k,
    const std::function<void(const Box3&, std::vector<std::array<Vec3, 3>>&)>& obstacle_near,
    const Progress& progress = {});

}  // namespace geo
