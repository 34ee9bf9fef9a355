// Neighbours of nodes (§ 6.2): everything within the support radius along the visibility graph.
#pragma once

#include "graph/visibility_graph.h"

namespace geo {

enum class NeighborMethod { automatic, dijkstra, mfw };

/// All neighbours of all nodes from scratch, into the graph. `mfw` is the paper's modified Floyd-Warshall, `dijkstra` a
/// plain bounded one, `automatic` the fastest we have; all give the same rows, bit for bit, for any number of threads and
/// any vector instructions. Memory of the edges' rows is used again while it runs: if it throws, the graph is lost.
void build_neighborhoods(const NodeSet& nodes, VisibilityGraph& graph, const TriangleBvh& obstacles,
                         NeighborMethod method = NeighborMethod::automatic, const Progress& progress = {});

}  // namespace geo
