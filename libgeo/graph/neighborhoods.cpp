// Bounded shortest paths on integer lengths. A distance is one 64-bit key, warped length in the high half and plain
// length in the low one: the smallest key is the shortest warped path and, among equals, the plainly shortest. Keys add
// without rounding, so every method below finds the same one.
#include "graph/neighborhoods.h"

#include <algorithm>
#include <queue>
#include <unordered_map>

#include "base/parallel.h"
#include "graph/visibility.h"

namespace geo {
namespace {

using Key = std::uint64_t;
constexpr Key far = ~Key(0);
Key key_of(const VisibilityGraph::Arc& a) { return Key(a.length) << 32 | a.plain; }
bool within(Key k) { return (k >> 32) < unit_radius; }

struct Search {
  std::vector<Key> best;
  std::vector<std::uint32_t> touched, queue;
  std::vector<std::uint8_t> queued;
};

// Label correcting with a first-in-first-out queue: rows are sorted by length, so each scan stops early.
void label_correcting(std::uint32_t source, const VisibilityGraph& graph, Search& s) {
  s.best.resize(graph.node_count(), far);
  s.queued.resize(graph.node_count(), 0);
  s.touched.clear();
  s.queue.assign(1, source);
  s.best[source] = 0;
  s.touched.push_back(source);
  for (std::size_t at = 0; at < s.queue.size(); ++at) {
    const auto u = s.queue[at];
    s.queued[u] = 0;
    const Key d = s.best[u];
    for (const auto& arc : graph.arcs(NodeId(u))) {
      const Key next = d + key_of(arc);
      if (!within(next)) break;
      Key& known = s.best[arc.to.index()];
      if (next >= known) continue;
      if (known == far) s.touched.push_back(arc.to.value);
      known = next;
      if (!s.queued[arc.to.index()]) s.queued[arc.to.index()] = 1, s.queue.push_back(arc.to.value);
    }
  }
}

void dijkstra(std::uint32_t source, const VisibilityGraph& graph, Search& s) {
  s.best.resize(graph.node_count(), far);
  s.touched.assign(1, source);
  s.best[source] = 0;
  std::priority_queue<std::pair<Key, std::uint32_t>, std::vector<std::pair<Key, std::uint32_t>>, std::greater<>> heap;
  heap.push({0, source});
  while (!heap.empty()) {
    const auto [d, u] = heap.top();
    heap.pop();
    if (d != s.best[u]) continue;
    for (const auto& arc : graph.arcs(NodeId(u))) {
      const Key next = d + key_of(arc);
      if (!within(next)) break;
      Key& known = s.best[arc.to.index()];
      if (next >= known) continue;
      if (known == far) s.touched.push_back(arc.to.value);
      known = next;
      heap.push({next, arc.to.value});
    }
  }
}

// Turns keys into a row: sorted by node, with the distance that weights use.
std::vector<Neighbor> finish_row(std::uint32_t i, std::vector<std::pair<std::uint32_t, Key>>& found, const NodeSet& nodes,
                                 const VisibilityGraph& graph, const std::function<bool(NodeId, NodeId)>& blocked) {
  std::sort(found.begin(), found.end());
  std::vector<std::uint32_t> seen;
  for (const auto& arc : graph.arcs(NodeId(i))) seen.push_back(arc.to.value);
  std::sort(seen.begin(), seen.end());
  std::vector<Neighbor> row;
  row.reserve(found.size());
  for (const auto& [j, key] : found) {
    const bool visible = std::binary_search(seen.begin(), seen.end(), j) || !blocked(NodeId(std::min(i, j)), NodeId(std::max(i, j)));
    const double distance = visible ? (nodes.position[i] - nodes.position[j]).norm() : double(std::uint32_t(key)) * graph.plain_unit();
    row.push_back({NodeId(j), std::uint32_t(key >> 32), static_cast<float>(distance)});
  }
  return row;
}

template <class Method>
std::vector<Neighbor> row_by(const Method& method, NodeId i, const NodeSet& nodes, const VisibilityGraph& graph,
                             const std::function<bool(NodeId, NodeId)>& blocked) {
  thread_local Search search;
  method(i.value, graph, search);
  std::vector<std::pair<std::uint32_t, Key>> found;
  for (const auto v : search.touched) {
    if (v != i.value) found.push_back({v, search.best[v]});
    search.best[v] = far;
  }
  return finish_row(i.value, found, nodes, graph, blocked);
}

// § 6.2: Floyd-Warshall on sparse rows; a path longer than the support is never stored.
std::vector<std::unordered_map<std::uint32_t, Key>> modified_floyd_warshall(const VisibilityGraph& graph) {
  std::vector<std::unordered_map<std::uint32_t, Key>> rows(graph.node_count());
  for (std::uint32_t i = 0; i < rows.size(); ++i)
    for (const auto& arc : graph.arcs(NodeId(i)))
      if (within(key_of(arc))) rows[i][arc.to.value] = key_of(arc);
  std::vector<std::pair<std::uint32_t, Key>> through;
  for (std::uint32_t k = 0; k < rows.size(); ++k) {
    through.assign(rows[k].begin(), rows[k].end());
    for (const auto& [i, di] : through)
      for (const auto& [j, dj] : through) {
        if (i == j || !within(di + dj)) continue;
        const auto [it, fresh] = rows[i].try_emplace(j, di + dj);
        if (!fresh) it->second = std::min(it->second, di + dj);
      }
  }
  return rows;
}

}  // namespace

std::vector<Neighbor> neighborhood_of(NodeId i, const NodeSet& nodes, const VisibilityGraph& graph,
                                      const std::function<bool(NodeId, NodeId)>& blocked) {
  return row_by(label_correcting, i, nodes, graph, blocked);
}

Neighborhoods build_neighborhoods(const NodeSet& nodes, const VisibilityGraph& graph, const TriangleBvh& obstacles,
                                  NeighborMethod method, const Progress& progress) {
  const std::size_t n = nodes.size();
  report(progress, "neighbourhoods", 0, n);
  const Visibility sight(nodes.position, obstacles);
  const auto blocked = [&](NodeId a, NodeId b) { return sight.blocked(a, b); };
  Neighborhoods all;
  all.rows.resize(n);
  if (method == NeighborMethod::mfw) {
    const auto rows = modified_floyd_warshall(graph);
    parallel_for(n, 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        std::vector<std::pair<std::uint32_t, Key>> found(rows[i].begin(), rows[i].end());
        all.rows[i] = finish_row(static_cast<std::uint32_t>(i), found, nodes, graph, blocked);
      }
    });
    return all;
  }
  parallel_for(n, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      all.rows[i] = method == NeighborMethod::dijkstra ? row_by(dijkstra, NodeId(i), nodes, graph, blocked)
                                                       : row_by(label_correcting, NodeId(i), nodes, graph, blocked);
  });
  return all;
}

}  // namespace geo
