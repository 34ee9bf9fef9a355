// Parts of the binding (§ 6.5) that the build and the split share.
//
// Each rule looks at a vertex and what is beside it, never at an order of events: a master is a vertex that is the
// closest one of some node; a slave is one step farther from the nearest master than its parent, the lowest vertex of
// which that is true. So a tree that is updated is the tree that a build from scratch grows.
#pragma once

#include <functional>

#include "kerf/body.h"

namespace geo {

/// No support radius, and so no distance from a node to its closest vertex, is larger. Model units.
double longest_reach(const Body& body);

/// The closest surface vertex within `reach` that p sees, of the fan that it sees; invalid when there is none. Exact.
SurfaceVertexId closest_vertex(const Complex& complex, const Vec3& p, double reach);

/// Of the nodes whose closest vertex v is, the nearest (ties: the lowest); invalid when v is no master.
NodeId master_node_of(const Body& body, const Binding& binding, SurfaceVertexId v);

/// The node that carries a shell that no node looks at, v being its lowest vertex: the nearest one that is accepted, of
/// its piece; invalid when there is none.
NodeId stray_node_of(const Body& body, SurfaceVertexId v, const std::function<bool(NodeId)>& accept);

/// Brings body.binding up to date after a step, equal to build_binding() bit for bit, at a cost that follows what has
/// changed. `moved`: old nodes that stand elsewhere now, or have another radius. Returns the surface vertices that
/// another node carries now, ascending.
std::vector<SurfaceVertexId> rebind(Body& body, const CrackDelta& delta, NodeId first_new,
                                    const std::vector<NodeId>& moved);

}  // namespace geo
