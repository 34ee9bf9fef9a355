// Up to 4096 sources share a local graph, and sixteen of them one batched search. Plain length of a
// hidden neighbour's path, with warped distances d: p(v) = min p(u) + |x_u − x_v| over edges uv
// with d(u) + length(uv) = d(v). So it is the least among all paths of least warped length.
#include "graph/neighborhood_search.h"

#include <algorithm>

#include "graph/batched_search.h"
#include "graph/local_graph.h"

namespace geo {
namespace {

// Sources that share one local graph. More: most nodes near a source are near others, too. Fewer:
// the local graph fits into a core's cache. Rows do not depend on it.
constexpr std::size_t sources_per_graph = 4096;

}  // namespace

// Memory of a search, and the row of one source at a time.
class NeighborhoodSearch::Scratch {
 public:
  LocalGraph local;
  BatchedSearch search;
  std::vector<std::uint16_t> bits;
  std::vector<float> paths;

  // The entries of the k-th source's row, without paths; ids of the first size() found.
  std::span<const std::uint32_t> make_entries(const NodeSet& nodes, const GraphStorage& graph, std::uint32_t i,
                                              std::size_t k, const BatchedSearch::Distances& found);
  // Lengths of the paths of hidden entries.
  void measure_paths(std::uint32_t source, std::span<const std::uint32_t> to, const BatchedSearch::Distances& found,
                     double plain_unit);

 private:
  // The last edge of a shortest path, in a list of all such edges to one node.
  struct LastEdge {
    std::uint32_t from, next;
  };
  static constexpr std::uint64_t unknown = ~std::uint64_t(0);

  void find_last_edges(std::uint32_t source, const BatchedSearch::Distances& found);
  std::uint64_t plain_length_to(std::uint32_t node, double unit);

  std::vector<std::uint32_t> to_;  // ids of a row with edges that join no neighbours
  // By local node, for one source: the warped distance, 0 where there is none; the head of its list
  // of last edges; its plain length or `unknown`.
  std::vector<std::uint32_t> distance_, first_edge_;
  std::vector<std::uint64_t> plain_;
  std::vector<LastEdge> last_edges_;  // [0] ends each list
};

// The edges uv that end shortest paths from a source: d(u) + length(uv) = d(v).
void NeighborhoodSearch::Scratch::find_last_edges(std::uint32_t source, const BatchedSearch::Distances& found) {
  distance_.resize(std::max<std::size_t>(distance_.size(), local.size()), 0);
  plain_.resize(distance_.size());
  first_edge_.resize(distance_.size());
  last_edges_.assign(1, {});
  for (std::size_t e = 0; e < found.node.size(); ++e) {
    const auto node = found.node[e];
    distance_[node] = found.distance[e] & ~BatchedSearch::edge_bit;
    plain_[node] = unknown;
    first_edge_[node] = 0;
  }
  plain_[source] = 0;
  const auto add_edges_from = [&](std::uint32_t node, std::uint32_t distance) {
    const auto end = LocalGraph::end_of_classes(distance);
    for (const auto edge : local.edges(node)) {
      if (edge.length >= end) break;
      if (distance + edge.length != distance_[edge.to]) continue;
      last_edges_.push_back({node, first_edge_[edge.to]});
      first_edge_[edge.to] = static_cast<std::uint32_t>(last_edges_.size() - 1);
    }
  };
  add_edges_from(source, 0);
  for (const auto node : found.node) add_edges_from(node, distance_[node]);
}

// The least plain length among all paths with the least warped length.
std::uint64_t NeighborhoodSearch::Scratch::plain_length_to(std::uint32_t node, double unit) {
  if (plain_[node] != unknown) return plain_[node];
  std::uint64_t least = unknown;
  const Vec3 to = local.position(node);
  for (auto e = first_edge_[node]; e != 0; e = last_edges_[e].next) {
    const auto from = last_edges_[e].from;
    least = std::min(least, plain_length_to(from, unit) + plain_length(local.position(from), to, unit));
  }
  return plain_[node] = least;
}

std::span<const std::uint32_t> NeighborhoodSearch::Scratch::make_entries(const NodeSet& nodes,
                                                                         const GraphStorage& graph, std::uint32_t i,
                                                                         std::size_t k,
                                                                         const BatchedSearch::Distances& found) {
  const auto size = static_cast<std::size_t>(
      std::lower_bound(found.node.begin(), found.node.end(), local.node_count()) - found.node.begin());
  bits.resize(size);
  paths.clear();
  for (std::size_t e = 0; e < size; ++e) {
    const auto d = found.distance[e];
    bits[e] = static_cast<std::uint16_t>((d & BatchedSearch::edge_bit) >> 16 | (d & ~BatchedSearch::edge_bit) >> 10);
  }
  if (!local.has_edge_only_entries(k)) return found.id.first(size);
  to_.assign(found.id.begin(), found.id.begin() + static_cast<std::ptrdiff_t>(size));
  insert_edge_only_entries(nodes, graph, i, to_, bits);
  return to_;
}

void NeighborhoodSearch::Scratch::measure_paths(std::uint32_t source, std::span<const std::uint32_t> to,
                                                const BatchedSearch::Distances& found, double plain_unit) {
  find_last_edges(source, found);
  for (std::size_t e = 0, f = 0; e < to.size(); ++e) {
    if (!AdjacencyRow::is_neighbor(bits[e])) continue;
    if (AdjacencyRow::has_path(bits[e]))
      paths.push_back(static_cast<float>(double(plain_length_to(found.node[f], plain_unit)) * plain_unit));
    ++f;
  }
  for (const auto node : found.node) distance_[node] = 0;
}

NeighborhoodSearch::NeighborhoodSearch() : scratch_(std::make_unique<Scratch>()) {}
NeighborhoodSearch::~NeighborhoodSearch() = default;

void insert_edge_only_entries(const NodeSet& nodes, const GraphStorage& graph, std::uint32_t i,
                              std::vector<std::uint32_t>& to, std::vector<std::uint16_t>& bits) {
  const auto row = graph.entries(i);
  for (std::size_t e = 0; e < row.to.size(); ++e) {
    if (!AdjacencyRow::is_edge(row.bits[e])) continue;
    const auto j = row.to[e];
    const auto length = graph.warped(nodes, i, j);
    if (length < unit_radius && !GraphStorage::is_guide(j)) continue;
    const auto k = std::lower_bound(to.begin(), to.end(), j) - to.begin();
    if (static_cast<std::size_t>(k) < to.size() && to[static_cast<std::size_t>(k)] == j) {
      bits[static_cast<std::size_t>(k)] |= AdjacencyRow::edge_bit;  // a neighbour by a shorter path
      continue;
    }
    to.insert(to.begin() + k, j);
    bits.insert(bits.begin() + k,
                AdjacencyRow::edge_bit | AdjacencyRow::path_bit | AdjacencyRow::bits_of_bound(length));
  }
}

void NeighborhoodSearch::run(const NodeSet& nodes, const GraphStorage& graph, std::span<const std::uint32_t> sources,
                             const MarkHidden& mark_hidden, const Store& store) {
  Scratch& s = *scratch_;
  std::vector<std::uint32_t> batch;
  for (std::size_t first = 0; first < sources.size(); first += sources_per_graph) {
    const std::size_t count = std::min(sources_per_graph, sources.size() - first);
    s.local.gather(nodes, graph, sources.subspan(first, count));
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t lane = k % BatchedSearch::lanes;
      if (lane == 0) {
        batch.clear();
        for (std::size_t l = k; l < std::min(count, k + BatchedSearch::lanes); ++l) batch.push_back(s.local.source(l));
        s.search.run(s.local, batch);
      }
      const auto i = sources[first + k];
      const auto found = s.search.distances(lane);
      const auto to = s.make_entries(nodes, graph, i, k, found);
      if (mark_hidden) {
        mark_hidden(i, to, s.bits);
        if (std::any_of(s.bits.begin(), s.bits.end(), AdjacencyRow::has_path))
          s.measure_paths(batch[lane], to, found, graph.plain_unit());
      }
      store(i, {to, s.bits, s.paths});
    }
  }
}

}  // namespace geo
