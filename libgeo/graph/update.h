// Incremental update of graph and neighbours (§ 6.3, 6.4): equal to a build from scratch, bit for
// bit.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "graph/guide_set.h"
#include "kerf/graph.h"
#include "kerf/progress.h"
#include "sampling/node_grid.h"

namespace geo {

/// Appends the triangles of K whose boxes meet a box. Must be safe to call from several threads.
using TrianglesNear = std::function<void(const Box3&, std::vector<std::array<Vec3, 3>>&)>;

/// The changes of a step around a graph. The graph itself is as before the step.
struct GraphChange {
  const NodeSet& nodes;          ///< new nodes included, all where they are after the step
  const NodeGrid& grid;          ///< over nodes.position
  NodeId first_new;              ///< P_new: nodes from here on are new and get edges to their k nearest visible nodes
  int k;                         ///< see build_visibility_graph()
  TrianglesNear triangles_near;  ///< of the whole complex after the step. Called only for pairs that were no
                                 ///< neighbours before, or with a new or moved node
  std::span<const std::array<Vec3, 3>> new_faces = {};    ///< crack faces and children of skin faces
  std::span<const NodeId> moved = {};                     ///< old nodes at another position: they lose their edges and
                                                          ///< are connected like new ones
  std::span<const NodeId> resized = {};                   ///< old nodes at the same position with another radius: they
                                                          ///< keep their edges, with other lengths
  std::span<const std::pair<NodeId, NodeId>> joins = {};  ///< pairs with a new node that see each other and get an edge
                                                          ///< at any distance
  GuideChange guides = {};                                ///< added guides stand beside the new faces
};

/// The changes that an update made. Pairs are nodes i < j, ascending; guides are left out.
struct GraphUpdate {
  std::vector<std::pair<NodeId, NodeId>> cut_edges;    ///< E_cut
  std::vector<std::pair<NodeId, NodeId>> added_edges;  ///< E_new
  std::vector<NodeId> updated_nodes;                   ///< P_update: nodes whose rows were recomputed, ascending
};

/// Updates edges and neighbours. The cost depends on the size of the change, not of the graph. If
/// `progress` stops it, the graph is lost.
GraphUpdate update_graph(const GraphChange& change, VisibilityGraph& graph, const Progress& progress = {});

}  // namespace geo
