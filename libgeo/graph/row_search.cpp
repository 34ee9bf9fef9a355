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
  std::vector<std::uint32_t> to;  // where a row has edges that join no neighbours
  std::vector<std::uint16_t> bits;
  std::vector<float> paths;
  // By local node, of one source: distances, 0 elsewhere; where they are known, plain lengths or `open`, and the last
  // of its Steps.
  std::vector<std::uint32_t> distance, last;
  std::vector<std::uint64_t> plain;
  struct Step {
    std::uint32_t from, before;  // another way there
  };
  std::vector<Step> steps;  // the last of some shortest path; the first is none
  static constexpr std::uint64_t open = ~std::uint64_t(0);

  void find_steps(std::uint32_t source, const LaneSearch::Row& found);
  std::uint64_t plain_length_to(std::uint32_t node, double unit);
  void forget_steps(const LaneSearch::Row& found) {
    for (const auto node : found.node) distance[node] = 0;
  }
};

// With which edges shortest paths from a source end.
void RowSearch::Work::find_steps(std::uint32_t source, const LaneSearch::Row& found) {
  distance.resize(std::max<std::size_t>(distance.size(), local.size()), 0);
  plain.resize(distance.size()), last.resize(distance.size());
  steps.assign(1, {});
  for (std::size_t e = 0; e < found.node.size(); ++e) {
    const auto node = found.node[e];
    distance[node] = found.distance[e] & ~LaneSearch::edge_bit, plain[node] = open, last[node] = 0;
  }
  plain[source] = 0;
  const auto from = [&](std::uint32_t node, std::uint32_t here) {
    const auto end = LocalGraph::end_of_classes(here);
    for (const auto edge : local.edges(node)) {
      if (edge.length >= end) break;
      if (here + edge.length != distance[edge.to]) continue;
      steps.push_back({node, last[edge.to]});
      last[edge.to] = static_cast<std::uint32_t>(steps.size() - 1);
    }
  };
  from(source, 0);
  for (const auto node : found.node) from(node, distance[node]);
}

// Of all paths with the least warped length, the plainly shortest.
std::uint64_t RowSearch::Work::plain_length_to(std::uint32_t node, double unit) {
  if (plain[node] != open) return plain[node];
  std::uint64_t least = open;
  const Vec3 to = local.position(node);
  for (auto s = last[node]; s != 0; s = steps[s].before) {
    const auto from = steps[s].from;
    least = std::min(least, plain_length_to(from, unit) + plain_length(local.position(from), to, unit));
  }
  return plain[node] = least;
}

RowSearch::RowSearch() : work_(std::make_unique<Work>()) {}
RowSearch::~RowSearch() = default;

void insert_bare_edges(const NodeSet& nodes, const VisibilityGraph& graph, std::uint32_t i,
                       std::vector<std::uint32_t>& to, std::vector<std::uint16_t>& bits) {
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
    bits.insert(bits.begin() + k,
                VisibilityGraph::edge_bit | VisibilityGraph::path_bit | VisibilityGraph::bits_of_bound(length));
  }
}

void RowSearch::run(const NodeSet& nodes, const VisibilityGraph& graph, std::span<const std::uint32_t> sources,
                    const Sight& sight, const Put& put) {
  Work& w = *work_;
  std::vector<std::uint32_t> lanes;
  for (std::size_t first = 0; first < sources.size(); first += block) {
    const std::size_t count = std::min(block, sources.size() - first);
    w.local.gather(nodes, graph, sources.subspan(first, count));
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t lane = k % LaneSearch::lanes;
      if (lane == 0) {
        lanes.clear();
        for (std::size_t l = k; l < std::min(count, k + LaneSearch::lanes); ++l) lanes.push_back(w.local.source(l));
        w.search.run(w.local, lanes);
      }
      const auto i = sources[first + k], source = lanes[lane];
      const auto found = w.search.row(lane);
      const auto size = static_cast<std::size_t>(
          std::lower_bound(found.node.begin(), found.node.end(), w.local.node_count()) - found.node.begin());
      std::span<const std::uint32_t> to = found.id.first(size);
      w.bits.resize(size), w.paths.clear();
      for (std::size_t e = 0; e < size; ++e) {
        const auto d = found.distance[e];
        w.bits[e] = static_cast<std::uint16_t>((d & LaneSearch::edge_bit) >> 16 | (d & ~LaneSearch::edge_bit) >> 10);
      }
      if (w.local.has_bare_edges(k)) {
        w.to.assign(to.begin(), to.end());
        insert_bare_edges(nodes, graph, i, w.to, w.bits);
        to = w.to;
      }
      if (sight) {
        sight(i, to, w.bits);
        if (std::any_of(w.bits.begin(), w.bits.end(), RowStore::has_path)) {
          w.find_steps(source, found);
          for (std::size_t e = 0, f = 0; e < to.size(); ++e) {
            if (!VisibilityGraph::is_neighbor(w.bits[e])) continue;
            if (RowStore::has_path(w.bits[e]))
              w.paths.push_back(static_cast<float>(double(w.plain_length_to(found.node[f], graph.plain_unit())) *
                                                   graph.plain_unit()));
            ++f;
          }
          w.forget_steps(found);
        }
      }
      put(i, {to, w.bits, w.paths});
    }
  }
}

}  // namespace geo
