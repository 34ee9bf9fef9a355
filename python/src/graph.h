// The visibility graph of the module, with its arrays.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "kerf/graph.h"
#include "nodes.h"

namespace kerf_python {

/// A graph that never changes after it was made, with its nodes. Arrays are made when they are
/// first wanted, and kept.
struct Graph {
  /// Takes the graph over.
  Graph(std::shared_ptr<const geo::NodeSet> n, geo::VisibilityGraph g) : nodes(std::move(n)), graph(std::move(g)) {}
  const std::shared_ptr<const geo::NodeSet> nodes;
  const geo::VisibilityGraph graph;

  py::object indptr, indices, distances;  ///< of the neighbours; null until made
  py::object warped, hidden;              ///< likewise, one value for each index
  py::object edges, edge_lengths;         ///< likewise
};

/// The method of a name in Python. Throws geo::InputError.
geo::NeighborMethod neighbor_method(const std::string& name);

}  // namespace kerf_python
