// Parts of the binding (§ 6.5) that the build and the update share.
//
// Every rule depends on a vertex and its neighbours on the surface, never on an order of events.
// Master: the closest visible vertex of some node; depth 0. Slave v: depth(v) = min depth(w) +
// step_from(w) over neighbours w, and its parent is the lowest w with that minimum. So an updated
// tree equals the tree of a build from scratch.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "kerf/body.h"

namespace geo {

/// Bound of all support radii, and so of all distances from a node to its closest vertex. Model
/// units.
double longest_reach(const Body& body);

/// The closest surface vertex within `reach` that p sees; where several surface vertices share its
/// site, the one on the side that p sees. Invalid when there is none. Exact.
SurfaceVertexId closest_vertex(const Complex& complex, const Vec3& p, double reach);

/// Whether a surface vertex lies on the border of a crack's sheet, where its two sides join.
bool is_on_border(const Complex& complex, SurfaceVertexId v);

/// By how much a slave is deeper than its parent v: 1. From a border of a sheet, whose vertices
/// belong to both sides, it is more than any way around: so a side takes nodes of its own, not of
/// the other.
std::uint32_t step_from(const Complex& complex, SurfaceVertexId v);

/// Among nodes i with closest[i] = v, the one nearest to v (ties: the lowest id). Invalid if there
/// is none: v is no master.
NodeId master_node_of(const Body& body, const Binding& binding, SurfaceVertexId v);

/// The nearest accepted node to v, the lowest vertex of a shell that no node sees; invalid when
/// there is none. `accept` limits the search to the piece of the shell.
NodeId carrier_of_unseen_shell(const Body& body, SurfaceVertexId v, const std::function<bool(NodeId)>& accept);

/// The node of a surface vertex's master; invalid for an orphan.
NodeId carrying_node(const Body& body, SurfaceVertexId v);

/// The nodes whose neighbours carry a surface vertex: that of its master. A vertex on the border of
/// a crack's sheet belongs to both sides, and has the nearest node of the masters of each, where
/// these differ. Invalid where there is none.
std::array<NodeId, 2> master_nodes(const Body& body, SurfaceVertexId v);

/// carrier_nodes() of a vertex whose master_nodes() are known.
void carriers_beside(const Body& body, SurfaceVertexId v, const std::array<NodeId, 2>& masters,
                     std::vector<std::pair<NodeId, double>>& out);

/// Nodes, ascending, and the closest surface vertex of each, as closest_vertex() finds it.
using ClosestVertices = std::vector<std::pair<NodeId, SurfaceVertexId>>;

/// Those of all nodes whose closest vertex may have changed by the new faces of a step. Reads
/// longest_reach() of the graph alone, which no step changes.
ClosestVertices closest_after(const Body& body, const CrackDelta& delta);

/// Updates body.binding after a step. The result equals that of build_binding(), bit for bit, at a
/// cost that follows the change.
class BindingUpdate {
 public:
  /// Refers to the body.
  explicit BindingUpdate(Body& body);
  ~BindingUpdate();
  BindingUpdate(const BindingUpdate&) = delete;
  BindingUpdate& operator=(const BindingUpdate&) = delete;

  /// The first part: masters and slaves of the shells that nodes see. Reads no labels of pieces,
  /// and longest_reach() of the graph alone. `first_new`: the first node that the step has added.
  /// `moved`: old nodes with another position or support radius, ascending. `closest`: of
  /// closest_after(), before nodes moved.
  void follow_step(const CrackDelta& delta, NodeId first_new, const std::vector<NodeId>& moved,
                   ClosestVertices closest);
  /// The second part, with labels of pieces that are up to date: masters of nodes added since, and
  /// of unseen shells. Returns the surface vertices with another carrying node, ascending.
  std::vector<SurfaceVertexId> finish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace geo
