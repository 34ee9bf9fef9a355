// Functions of kerf/graph.h for obstacles that are already in a tree.
#pragma once

#include "geometry/bvh.h"
#include "kerf/graph.h"

namespace geo {

/// See build_visibility_graph() in kerf/graph.h.
VisibilityGraph build_visibility_graph(const NodeSet& nodes, const TriangleBvh& obstacles, int k,
                                       const Progress& progress = {});

/// See build_neighborhoods() in kerf/graph.h.
void build_neighborhoods(const NodeSet& nodes, VisibilityGraph& graph, const TriangleBvh& obstacles,
                         NeighborMethod method = NeighborMethod::automatic, const Progress& progress = {});

}  // namespace geo
