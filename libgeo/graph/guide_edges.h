// Edges of guides in the visibility graph (§ 8).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/bvh.h"
#include "graph/graph_storage.h"
#include "sampling/node_grid.h"

namespace geo {

/// Adds guides to a graph that has no neighbours yet. Guide g gets an edge to every visible node
/// within r_g, and to every visible guide h within max(r_g, r_h). `grid` is over nodes.position.
void add_guides(const NodeSet& nodes, const NodeGrid& grid, const TriangleBvh& obstacles, std::span<const Guide> guides,
                VisibilityGraph& graph);

// ---- Shared by build and update.

/// Appends the ids of the nodes, and of the guides with lower ids, that a guide has an edge to if
/// it sees them.
void ids_near_guide(const NodeSet& nodes, const NodeGrid& grid, const GraphStorage& graph, std::uint32_t guide,
                    std::vector<std::uint32_t>& ids);
/// Appends the ids of the guides that a node has an edge to if it sees them.
void guides_near(const NodeSet& nodes, const GraphStorage& graph, std::uint32_t node, std::vector<std::uint32_t>& ids);
/// Adds the edges of the last visible.size() guides, which have none yet. visible[k]: the ids of
/// ids_near_guide() that the k-th of these guides sees.
void add_guide_edges(const NodeSet& nodes, std::span<const std::vector<std::uint32_t>> visible, GraphStorage& graph);

}  // namespace geo
