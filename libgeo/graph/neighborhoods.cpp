#include "kerf/graph.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "graph/block_release.h"
#include "graph/reference_rows.h"
#include "graph/row_search.h"
#include "graph/visibility.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

// A row from its distances, as RowSearch makes it.
class RowMaker {
 public:
  RowMaker(const NodeSet& nodes, const VisibilityGraph& graph, const RowSearch::Sight& sight)
      : nodes_(nodes), graph_(graph), sight_(sight) {}
  RowView make(std::uint32_t i, const PathRow& found) {
    to_.clear(), bits_.clear(), paths_.clear();
    for (const auto& [j, length] : found) {
      if (j >= graph_.node_count()) break;  // guides
      to_.push_back(j);
      const std::uint16_t edge = graph_.has(NodeId(i), NodeId(j)) ? VisibilityGraph::edge_bit : 0;
      bits_.push_back(edge | VisibilityGraph::bits_of_bound(static_cast<std::uint32_t>(length >> 32)));
    }
    if (sight_) sight_(i, to_, bits_);
    for (std::size_t k = 0; k < to_.size(); ++k)
      if (RowStore::has_path(bits_[k]))
        paths_.push_back(static_cast<float>(double(static_cast<std::uint32_t>(found[k].second)) * graph_.plain_unit()));
    insert_bare_edges(nodes_, graph_, i, to_, bits_);
    return {to_, bits_, paths_};
  }

 private:
  const NodeSet& nodes_;
  const VisibilityGraph& graph_;
  const RowSearch::Sight& sight_;
  std::vector<std::uint32_t> to_;
  std::vector<std::uint16_t> bits_;
  std::vector<float> paths_;
};

}  // namespace

void build_neighborhoods(const NodeSet& nodes, VisibilityGraph& graph, const TriangleBvh& obstacles,
                         NeighborMethod method, const Progress& progress) {
  const std::size_t n = nodes.size();
  report(progress, "neighbourhoods", 0, n);
  std::optional<Visibility> visibility;
  RowSearch::Sight sight;
  if (!obstacles.empty()) {
    visibility.emplace(nodes.position, obstacles);
    sight = [&](std::uint32_t i, std::span<const std::uint32_t> to, std::span<std::uint16_t> bits) {
      thread_local std::vector<NodeId> asked;
      thread_local std::vector<std::uint8_t> blocked;
      asked.clear();
      for (std::size_t k = 0; k < to.size(); ++k)
        if (!VisibilityGraph::is_edge(bits[k])) asked.push_back(NodeId(to[k]));
      blocked.resize(asked.size());
      visibility->blocked(NodeId(i), asked, blocked);
      for (std::size_t k = 0, a = 0; k < to.size(); ++k)
        if (!VisibilityGraph::is_edge(bits[k]) && blocked[a++]) bits[k] |= VisibilityGraph::path_bit;
    };
  }
  RowStore rows;
  rows.resize(n);
  if (method == NeighborMethod::automatic) {
    constexpr std::size_t grain = 1024;
    BlockRelease release(nodes, graph, grain, rows);
    parallel_for((n + grain - 1) / grain, 1, [&](std::size_t begin, std::size_t end) {
      thread_local RowSearch search;
      RowStore::Writer writer(rows);
      std::vector<std::uint32_t> sources;
      for (std::size_t run = begin; run < end; ++run) {
        sources.resize(std::min(grain, n - run * grain));
        std::iota(sources.begin(), sources.end(), static_cast<std::uint32_t>(run * grain));
        search.run(nodes, graph, sources, sight, [&](std::uint32_t i, const RowView& row) { writer.set(i, row); });
        release.done(run);
      }
    });
    rows.drop_spare();
  } else {
    const auto edges = edge_lengths(nodes, graph);
    std::vector<PathRow> all;
    if (method == NeighborMethod::mfw) all = modified_floyd_warshall(edges);
    parallel_for(n, 1024, [&](std::size_t begin, std::size_t end) {
      RowStore::Writer writer(rows);
      RowMaker maker(nodes, graph, sight);
      std::optional<BoundedDijkstra> dijkstra;
      if (method == NeighborMethod::dijkstra) dijkstra.emplace(edges);
      PathRow row;
      for (std::size_t i = begin; i < end; ++i) {
        if (dijkstra) dijkstra->run(static_cast<std::uint32_t>(i), row);
        writer.set(i, maker.make(static_cast<std::uint32_t>(i), dijkstra ? row : all[i]));
      }
    });
  }
  graph.replace_rows(std::move(rows));
}

}  // namespace geo
