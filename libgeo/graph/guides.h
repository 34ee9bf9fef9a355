// Guides in the visibility graph (§ 8): which edges they have.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/bvh.h"
#include "kerf/graph.h"
#include "sampling/node_grid.h"

namespace geo {

/// Adds guides to a graph, before its neighbourhoods are built. Each gets an edge to every node that it sees within its
/// radius, and to every guide that it sees if one of the two is within the other's radius. `grid` holds all nodes.
void add_guides(const NodeSet& nodes, const NodeGrid& grid, const TriangleBvh& obstacles, std::span<const Guide> guides,
                VisibilityGraph& graph);

// What builds and updates share:

/// Appends the ids of the nodes, and of the guides older than itself, to which a guide has an edge if it sees them.
void near_guide(const NodeSet& nodes, const NodeGrid& grid, const VisibilityGraph& graph, std::uint32_t guide,
                std::vector<std::uint32_t>& ids);
/// Appends the ids of the guides to which a node has an edge if it sees them.
void guides_near(const NodeSet& nodes, const VisibilityGraph& graph, std::uint32_t node,
                 std::vector<std::uint32_t>& ids);
/// Gives their edges to the last guides, which have none yet: seen[k] are the ids that the k-th of them sees, of those
/// near it.
void join_guides(const NodeSet& nodes, std::span<const std::vector<std::uint32_t>> seen, VisibilityGraph& graph);

}  // namespace geo
