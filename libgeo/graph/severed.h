// Which edges and pairs of neighbours new faces cut (§ 6.3).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/visibility_graph.h"
#include "sampling/node_grid.h"

namespace geo {

/// Two nodes or guides, the lower one in the upper half: sorts by nodes.
using NodePairKey = std::uint64_t;
constexpr NodePairKey pair_key(std::uint32_t i, std::uint32_t j) { return NodePairKey(i < j ? i : j) << 32 | (i < j ? j : i); }

struct Severed {
  std::vector<NodePairKey> edges;      ///< that a face touches, ascending
  std::vector<NodePairKey> neighbors;  ///< pairs of neighbours, edges or not, between which a face came, ascending
};

/// Looks among guides and nodes before `first_new`, at a cost that follows the faces' area. `grid` holds all nodes.
Severed find_severed(const NodeSet& nodes, const VisibilityGraph& graph, const NodeGrid& grid, NodeId first_new,
                     std::span<const std::array<Vec3, 3>> faces);

}  // namespace geo
