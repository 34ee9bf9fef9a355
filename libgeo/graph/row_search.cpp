#include "graph/row_search.h"

#include <algorithm>

#include "graph/lane_search.h"
#include "graph/local_graph.h"

namespace geo {
namespace {

// Enough that most of what is near a source belongs to other sources too, and fits into a core's cache.
constexpr std::size_t block = 4096;

}  // namespace

struct RowSearch::Work {
  LocalGraph local;
  LaneSearch search;
  std::vector<std::uint16_t> mark;   // by local node: edge_bit for the other ends of a source's edges
  std::vector<std::uint32_t> to;
  std::vector<std::uint16_t> bits;
  std::vector<float> paths;
  std::vector<std::uint32_t> distance;  // by local node, of one source; 0 elsewhere
  std::vector<std::uint64_t> plain;     // where distance is known
  std::vector<std::uint64_t> order;     // nodes, their distances in the upper half

  void plain_lengths(double unit, std::uint32_t source, std::span<const LaneSearch::Found> found);
};

// Of all paths with the least warped length, the plainly shortest: nearer nodes first.
void RowSearch::Work::plain_lengths(double unit, std::uint32_t source, std::span<const LaneSearch::Found> found) {
  distance.resize(std::max<std::size_t>(distance.size(), local.size()), 0);
  plain.resize(distance.size());
  order.clear();
  for (const auto& f : found) {
    distance[f.node] = f.distance, plain[f.node] = ~std::uint64_t(0);
    order.push_back(std::uint64_t(f.distance) << 32 | f.node);
  }
  std::sort(order.begin(), order.end());
  plain[source] = 0;
  order.insert(order.begin(), source);
  for (const auto entry : order) {
    const auto node = static_cast<std::uint32_t>(entry), here = static_cast<std::uint32_t>(entry >> 32);
    const Vec3 from = local.position(node);
    const auto end = LocalGraph::end_of_classes(here);
    for (const auto edge : local.edges(node)) {
      if (edge.length >= end) break;
      if (here + edge.length == distance[edge.to]) plain[edge.to] = std::min(plain[edge.to], plain[node] + plain_length(from, local.position(edge.to), unit));
    }
  }
  for (const auto& f : found) distance[f.node] = 0;
}

RowSearch::RowSearch() : work_(std::make_unique<Work>()) {}
RowSearch::~RowSearch() = default;

void insert_bare_edges(const NodeSet& nodes, const VisibilityGraph& graph, std::uint32_t i, std::vector<std::uint32_t>& to,
                       std::vector<std::uint16_t>& bits) {
  const auto row = graph.entries(i);
  for (std::size_t e = 0; e < row.to.size(); ++e) {
    if (!VisibilityGraph::is_edge(row.bits[e])) continue;
    const auto j = row.to[e];
    const auto length = graph.warped(nodes, i, j);
    if (length < unit_radius && !VisibilityGraph::is_guide(j)) continue;
    const auto k = std::lower_bound(to.begin(), to.end(), j) - to.begin();
    if (static_cast<std::size_t>(k) < to.size() && to[static_cast<std::size_t>(k)] == j) {
      bits[static_cast<std::size_t>(k)] |= VisibilityGraph::edge_bit;  // near by another way
      continue;
    }
    to.insert(to.begin() + k, j);
    bits.insert(bits.begin() + k, VisibilityGraph::edge_bit | VisibilityGraph::path_bit | VisibilityGraph::bits_of_bound(length));
  }
}

void RowSearch::run(const NodeSet& nodes, const VisibilityGraph& graph, std::span<const std::uint32_t> sources, const Sight& sight,
                    const Put& put) {
  Work& w = *work_;
  std::vector<std::uint32_t> lanes;
  for (std::size_t first = 0; first < sources.size(); first += block) {
    const std::size_t count = std::min(block, sources.size() - first);
    w.local.gather(nodes, graph, sources.subspan(first, count));
    w.mark.resize(std::max<std::size_t>(w.mark.size(), w.local.size()), 0);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t lane = k % LaneSearch::lanes;
      if (lane == 0) {
        lanes.clear();
        for (std::size_t l = k; l < std::min(count, k + LaneSearch::lanes); ++l) lanes.push_back(w.local.source(l));
        w.search.run(w.local, lanes);
      }
      const auto i = sources[first + k], source = lanes[lane];
      const auto all = w.search.row(lane);
      const auto found = all.first(static_cast<std::size_t>(
          std::partition_point(all.begin(), all.end(), [&](const auto& f) { return f.node < w.local.node_count(); }) - all.begin()));
      const auto edges = w.local.edges(source);
      for (const auto edge : edges) w.mark[edge.to] = VisibilityGraph::edge_bit;
      w.to.resize(found.size()), w.bits.resize(found.size()), w.paths.clear();
      for (std::size_t e = 0; e < found.size(); ++e) {
        w.to[e] = w.local.id(found[e].node);
        w.bits[e] = static_cast<std::uint16_t>(w.mark[found[e].node] | found[e].distance >> 10);
      }
      for (const auto edge : edges) w.mark[edge.to] = 0;
      if (w.local.has_bare_edges(k)) insert_bare_edges(nodes, graph, i, w.to, w.bits);
      if (sight) {
        sight(i, w.to, w.bits);
        if (std::any_of(w.bits.begin(), w.bits.end(), RowStore::has_path)) {
          w.plain_lengths(graph.plain_unit(), source, all);
          for (std::size_t e = 0, f = 0; e < w.to.size(); ++e) {
            if (!VisibilityGraph::is_neighbor(w.bits[e])) continue;
            if (RowStore::has_path(w.bits[e])) w.paths.push_back(static_cast<float>(double(w.plain[found[f].node]) * graph.plain_unit()));
            ++f;
          }
        }
      }
      put(i, {w.to, w.bits, w.paths});
    }
  }
}

}  // namespace geo
