// Adjacency rows with neighbours (§ 6.2) of many nodes: the search that builds and updates share.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "graph/graph_storage.h"

namespace geo {

/// Finds the neighbours of nodes by shortest paths along the graph, bounded by the support radius.
/// One object for each thread; it keeps its memory from one run to the next.
class NeighborhoodSearch {
 public:
  /// Sets path_bit of each pair (i, to[k]) that a face hides. Entries with edge_bit see each other.
  using MarkHidden =
      std::function<void(std::uint32_t i, std::span<const std::uint32_t> to, std::span<std::uint16_t> bits)>;
  /// Receives the row of a node; the row is valid during the call.
  using Store = std::function<void(std::uint32_t i, const AdjacencyRow& row)>;

  /// A search without memory yet.
  NeighborhoodSearch();
  ~NeighborhoodSearch();
  /// Finds the rows of `sources` (ascending; nodes or guides) along all edges of the graph, and
  /// calls `store` for each, in order. With an empty `mark_hidden` all pairs see each other.
  /// `store` may change the graph's neighbours but not its edges.
  void run(const NodeSet& nodes, const GraphStorage& graph, std::span<const std::uint32_t> sources,
           const MarkHidden& mark_hidden, const Store& store);

 private:
  class Scratch;
  std::unique_ptr<Scratch> scratch_;
};

/// Inserts into the row of node i (ids and bits) its edges that join no neighbours: edges as long
/// as the support, and edges to guides.
void insert_edge_only_entries(const NodeSet& nodes, const GraphStorage& graph, std::uint32_t i,
                              std::vector<std::uint32_t>& to, std::vector<std::uint16_t>& bits);

}  // namespace geo
