// Rows of neighbours (§ 6.2) of many nodes: the search that builds and updates share.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "kerf/graph.h"

namespace geo {

class RowSearch {
 public:
  /// Sets path_bit of each pair (i, to[k]) that does not see itself; called with entries without edge_bit among others.
  using Sight = std::function<void(std::uint32_t i, std::span<const std::uint32_t> to, std::span<std::uint16_t> bits)>;
  using Put = std::function<void(std::uint32_t i, const RowView& row)>;

  RowSearch();
  ~RowSearch();
  /// The rows of some nodes (ascending; guides, too) along the graph as it is, with all edges: calls `put` for each, in
  /// order. An empty `sight` sees everything. `put` may change the graph's neighbours but not its edges. One search a
  /// thread.
  void run(const NodeSet& nodes, const VisibilityGraph& graph, std::span<const std::uint32_t> sources,
           const Sight& sight, const Put& put);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

/// Puts entries for those edges of a node into its row that join no neighbours: as long as the support, or to guides.
void insert_bare_edges(const NodeSet& nodes, const VisibilityGraph& graph, std::uint32_t i,
                       std::vector<std::uint32_t>& to, std::vector<std::uint16_t>& bits);

}  // namespace geo
