// Edges of the visibility graph in the order in which exports write them.
#pragma once

#include "kerf/body.h"

namespace geo {

/// Calls each(i, j) for every edge i < j of the graph, i ascending.
template <class Each>
void each_edge(const Body& body, const Each& each) {
  for (std::uint32_t i = 0; i < body.nodes.size(); ++i)
    for (const NodeId j : body.graph.edges(NodeId(i)))
      if (j.value > i) each(i, j.value);
}

}  // namespace geo
