// build_neighborhoods() of kerf/graph.h and graph/build_graph.h. Neighbours of all nodes from
// scratch (§ 6.2), by three methods that agree bit for bit.
#include <algorithm>
#include <numeric>
#include <optional>

#include "graph/block_release.h"
#include "graph/build_graph.h"
#include "graph/graph_storage.h"
#include "graph/neighborhood_search.h"
#include "graph/reference_neighborhoods.h"
#include "graph/visibility.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

// Sets path_bit of the pairs that a face hides. Edges see each other.
NeighborhoodSearch::MarkHidden hidden_by(const Visibility& visibility) {
  return [&visibility](std::uint32_t i, std::span<const std::uint32_t> to, std::span<std::uint16_t> bits) {
    thread_local std::vector<NodeId> tested;
    thread_local std::vector<std::uint8_t> blocked;
    tested.clear();
    for (std::size_t k = 0; k < to.size(); ++k)
      if (!AdjacencyRow::is_edge(bits[k])) tested.push_back(NodeId(to[k]));
    blocked.resize(tested.size());
    visibility.blocked(NodeId(i), tested, blocked);
    for (std::size_t k = 0, t = 0; k < to.size(); ++k)
      if (!AdjacencyRow::is_edge(bits[k]) && blocked[t++]) bits[k] |= AdjacencyRow::path_bit;
  };
}

// Makes adjacency rows from distances, as NeighborhoodSearch makes them.
class RowMaker {
 public:
  RowMaker(const NodeSet& nodes, const GraphStorage& graph, const NeighborhoodSearch::MarkHidden& mark_hidden)
      : nodes_(nodes), graph_(graph), mark_hidden_(mark_hidden) {}
  /// The row of node i; valid until the next call.
  AdjacencyRow make(std::uint32_t i, const PathDistances& distances) {
    to_.clear();
    bits_.clear();
    paths_.clear();
    for (const auto& [j, length] : distances) {
      if (j >= graph_.node_count()) break;  // guides
      to_.push_back(j);
      const std::uint16_t edge = graph_.has(i, j) ? AdjacencyRow::edge_bit : 0;
      bits_.push_back(edge | AdjacencyRow::bits_of_bound(static_cast<std::uint32_t>(length >> 32)));
    }
    if (mark_hidden_) mark_hidden_(i, to_, bits_);
    for (std::size_t k = 0; k < to_.size(); ++k)
      if (AdjacencyRow::has_path(bits_[k]))
        paths_.push_back(
            static_cast<float>(double(static_cast<std::uint32_t>(distances[k].second)) * graph_.plain_unit()));
    insert_edge_only_entries(nodes_, graph_, i, to_, bits_);
    return {to_, bits_, paths_};
  }

 private:
  const NodeSet& nodes_;
  const GraphStorage& graph_;
  const NeighborhoodSearch::MarkHidden& mark_hidden_;
  std::vector<std::uint32_t> to_;
  std::vector<std::uint16_t> bits_;
  std::vector<float> paths_;
};

void search_all(const NodeSet& nodes, GraphStorage& graph, const NeighborhoodSearch::MarkHidden& mark_hidden,
                AdjacencyStore& rows) {
  // Nodes of a run. Smaller: blocks are released earlier; larger: local graphs are shared by more
  // sources.
  constexpr std::size_t grain = 1024;
  const std::size_t n = nodes.size();
  BlockRelease release(nodes, graph, grain, rows);
  parallel_for((n + grain - 1) / grain, 1, [&](std::size_t begin, std::size_t end) {
    thread_local NeighborhoodSearch search;
    AdjacencyStore::Writer writer(rows);
    std::vector<std::uint32_t> sources;
    for (std::size_t run = begin; run < end; ++run) {
      sources.resize(std::min(grain, n - run * grain));
      std::iota(sources.begin(), sources.end(), static_cast<std::uint32_t>(run * grain));
      search.run(nodes, graph, sources, mark_hidden,
                 [&](std::uint32_t i, const AdjacencyRow& row) { writer.set(i, row); });
      release.done(run);
    }
  });
  rows.drop_spare();
}

void search_by_reference(const NodeSet& nodes, const GraphStorage& graph,
                         const NeighborhoodSearch::MarkHidden& mark_hidden, NeighborMethod method,
                         AdjacencyStore& rows) {
  const auto edges = edge_lengths(nodes, graph);
  std::vector<PathDistances> all;
  if (method == NeighborMethod::mfw) all = modified_floyd_warshall(edges);
  parallel_for(nodes.size(), 1024, [&](std::size_t begin, std::size_t end) {
    AdjacencyStore::Writer writer(rows);
    RowMaker maker(nodes, graph, mark_hidden);
    std::optional<BoundedDijkstra> dijkstra;
    if (method == NeighborMethod::dijkstra) dijkstra.emplace(edges);
    PathDistances distances;
    for (std::size_t i = begin; i < end; ++i) {
      if (dijkstra) dijkstra->run(static_cast<std::uint32_t>(i), distances);
      writer.set(i, maker.make(static_cast<std::uint32_t>(i), dijkstra ? distances : all[i]));
    }
  });
}

}  // namespace

void build_neighborhoods(const NodeSet& nodes, VisibilityGraph& graph, const TriangleBvh& obstacles,
                         NeighborMethod method, const Progress& progress) {
  report(progress, "neighbourhoods", 0, nodes.size());
  const Visibility visibility(nodes.position, obstacles);
  NeighborhoodSearch::MarkHidden mark_hidden;
  if (!obstacles.empty()) mark_hidden = hidden_by(visibility);
  AdjacencyStore rows;
  rows.resize(nodes.size());
  if (method == NeighborMethod::automatic)
    search_all(nodes, GraphStorage::of(graph), mark_hidden, rows);
  else
    search_by_reference(nodes, GraphStorage::of(graph), mark_hidden, method, rows);
  GraphStorage::of(graph).replace_rows(std::move(rows));
}

void build_neighborhoods(const NodeSet& nodes, VisibilityGraph& graph, std::span<const std::array<Vec3, 3>> obstacles,
                         NeighborMethod method, const Progress& progress) {
  build_neighborhoods(nodes, graph, TriangleBvh(obstacles), method, progress);
}

}  // namespace geo
