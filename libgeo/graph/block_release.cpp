// A run reads rows of nodes within `reach` of its bounding box. A block of rows is released when
// the count of runs whose grown box meets the block's box falls to 0.
#include "graph/block_release.h"

#include <algorithm>

namespace geo {

BlockRelease::BlockRelease(const NodeSet& nodes, GraphStorage& graph, std::size_t run_length, AdjacencyStore& to)
    : graph_(graph), to_(to) {
  const std::size_t n = nodes.size();
  // A search follows lower bounds b of lengths L, with L < b + 2¹⁰. So the length of a path is at
  // most 1 + 1024 / b_min times the sum of its bounds. If b_min = 0, a search may reach any node,
  // and all blocks are kept.
  std::uint32_t shortest = unit_radius;
  for (std::uint32_t i = 0; i < n; ++i)
    shortest = std::min(shortest, AdjacencyRow::bound(graph.rows().lowest_bound(i)));
  const GraphStorage& all = graph;
  for (std::uint32_t g = 0; g < graph.guides().size(); ++g)
    shortest = std::min(shortest, AdjacencyRow::bound(all.store(GraphStorage::guide_id(0)).lowest_bound(g)));
  if (shortest == 0) return;
  const double reach = graph.longest_edge() * (1 + 1024.0 / shortest) * (1 + 1e-6);
  blocks_.resize(graph.rows().block_count());
  for (std::size_t i = 0; i < n; ++i) {
    if (i % run_length == 0) read_.emplace_back();
    read_.back().add(nodes.position[i]);
    if (!graph.rows().entries(i).to.empty()) blocks_[graph.rows().block_of(i)].add(nodes.position[i]);
  }
  readers_ = std::vector<std::atomic<std::uint32_t>>(blocks_.size());
  for (Box3& box : read_) {
    box = box.grown(reach);
    for (std::size_t b = 0; b < blocks_.size(); ++b) readers_[b] += box.meets(blocks_[b]);
  }
}

void BlockRelease::done(std::size_t run) {
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    if (read_[run].meets(blocks_[b]) && --readers_[b] == 0) graph_.give_block(static_cast<std::uint32_t>(b), to_);
}

}  // namespace geo
