// The nearest visible nodes of new nodes (§ 6.4).
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

/// For each of `ids` the k nearest nodes that it sees among its 3 k nearest, nearest first. `grid`
/// is over all nodes. `obstacles_near` appends the triangles whose boxes meet a box; it is called
/// from several threads.
std::vector<std::vector<std::uint32_t>> nearest_visible(
    const NodeSet& nodes, const NodeGrid& grid, std::span<const std::uint32_t> ids, int k,
    const std::function<void(const Box3&, std::vector<std::array<Vec3, 3>>&)>& obstacles_near,
    const Progress& progress = {});

}  // namespace geo
