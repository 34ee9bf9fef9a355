// Rows of neighbours by textbook methods, one source or one node at a time: what faster ones are
// held to.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "graph/graph_storage.h"

namespace geo {

/// A distance as one number, warped length in the high half and plain length in the low one: the
/// smallest is the shortest warped path and, among equals, the plainly shortest. They add without
/// rounding.
using PathLength = std::uint64_t;
using PathDistances = std::vector<std::pair<std::uint32_t, PathLength>>;

/// The graph's edges with their lengths, those shorter than the support. Guides follow the nodes.
std::vector<PathDistances> edge_lengths(const NodeSet& nodes, const GraphStorage& graph);

/// Dijkstra from one node, bounded by the support; ascending by node, without the node itself.
class BoundedDijkstra {
 public:
  explicit BoundedDijkstra(const std::vector<PathDistances>& edges)
      : edges_(edges), best_(edges.size(), ~PathLength(0)) {}
  void run(std::uint32_t source, PathDistances& row);

 private:
  const std::vector<PathDistances>& edges_;
  std::vector<PathLength> best_;
  std::vector<std::pair<PathLength, std::uint32_t>> heap_;
};

/// § 6.2: the modified Floyd-Warshall on sparse rows; a path longer than the support is never
/// stored.
std::vector<PathDistances> modified_floyd_warshall(const std::vector<PathDistances>& edges);

}  // namespace geo
