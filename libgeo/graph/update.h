// Incremental update of graph and neighbours (§ 6.3, 6.4): equal to a build from scratch, bit for bit.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "kerf/graph.h"
#include "kerf/progress.h"
#include "sampling/node_grid.h"

namespace geo {

struct GraphUpdate {
  std::vector<std::pair<NodeId, NodeId>> cut_edges;    ///< E_cut, i < j; of nodes
  std::vector<std::pair<NodeId, NodeId>> added_edges;  ///< E_new; of nodes
  std::vector<NodeId> updated_nodes;                   ///< P_update: nodes whose rows were recomputed, ascending
};

/// `new_faces`: the triangles that the step added to the complex (crack faces and children of cut skin). `first_new`:
/// nodes from this row on are new (P_new) and get edges to their k nearest visible nodes. `obstacle_near` must append
/// the triangles of the whole complex whose boxes meet a box (asked only for pairs that were no neighbours before, or
/// of which one is new or moved). `moved` lists old nodes whose position has changed, with or without the radius: they
/// lose their edges and are connected anew. `resized` lists old nodes that stay where they are with another radius:
/// they keep their edges, whose lengths have changed. `grid` holds all nodes where they are now. `joins`: pairs with a
/// new node that see each other and get an edge however far apart they are. `guides`: those that the graph gets, which
/// see past the new faces, and those that it needs no longer. Precondition: `nodes` already holds the new nodes;
/// `graph` is as before the step. The cost follows what changes, not what there is. Where `progress` stops the work,
/// graph is of no more use.
GraphUpdate update_graph(const NodeSet& nodes, NodeId first_new, std::span<const NodeId> moved,
                         std::span<const std::array<Vec3, 3>> new_faces,
                         const std::function<void(const Box3&, std::vector<std::array<Vec3, 3>>&)>& obstacle_near,
                         int k, const NodeGrid& grid, VisibilityGraph& graph,
                         std::span<const std::pair<NodeId, NodeId>> joins = {}, const GuideChange& guides = {},
                         const Progress& progress = {}, std::span<const NodeId> resized = {});

}  // namespace geo
