// Neighbourhoods by textbook methods, one source or one node at a time: the reference for faster
// ones.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "graph/graph_storage.h"

namespace geo {

/// A distance as one number: warped length in the high half, plain length in the low half. The
/// smallest is the path with the least warped length and, among equals, the least plain length.
/// Sums are exact.
using PathLength = std::uint64_t;
/// Pairs (node, distance), ascending by node.
using PathDistances = std::vector<std::pair<std::uint32_t, PathLength>>;

/// The edges shorter than the support radius with their lengths, by node. Guides follow the nodes,
/// numbered from graph.node_count() on.
std::vector<PathDistances> edge_lengths(const NodeSet& nodes, const GraphStorage& graph);

/// Dijkstra's algorithm from one node, bounded by the support radius.
class BoundedDijkstra {
 public:
  /// Over edge_lengths(), which must outlive the object.
  explicit BoundedDijkstra(const std::vector<PathDistances>& edges)
      : edges_(edges), best_(edges.size(), ~PathLength(0)) {}
  /// Writes the distances from `source` to all nodes within the support radius, without `source`.
  void run(std::uint32_t source, PathDistances& distances);

 private:
  const std::vector<PathDistances>& edges_;
  std::vector<PathLength> best_;
  std::vector<std::pair<PathLength, std::uint32_t>> heap_;
};

/// § 6.2: the modified Floyd–Warshall algorithm on sparse rows. It never stores a path longer than
/// the support radius.
std::vector<PathDistances> modified_floyd_warshall(const std::vector<PathDistances>& edges);

}  // namespace geo
