// Dijkstra's algorithm with a binary heap, and the modified Floyd–Warshall algorithm (§ 6.2). Its
// matrix D has sparse rows: hash tables of the distances that are below the support radius.
#include "graph/reference_neighborhoods.h"

#include <algorithm>
#include <bit>

#include "kerf/parallel.h"

namespace geo {
namespace {

constexpr PathLength far = ~PathLength(0), radius = PathLength(unit_radius) << 32;

// A row of the distance matrix D: a hash table without deletion.
class SparseRow {
 public:
  SparseRow() : slots_(64) {}
  void shorten(std::uint32_t to, PathLength length) {
    Slot& slot = find(to);
    if (slot.to == none) {
      if (2 * ++count_ > slots_.size()) {
        grow();
        find(to) = {to, length};
      } else {
        slot = {to, length};
      }
    } else if (length < slot.length) {
      slot.length = length;
    }
  }
  template <class F>
  void each(const F& f) const {
    for (const Slot& s : slots_)
      if (s.to != none) f(s.to, s.length);
  }

 private:
  static constexpr std::uint32_t none = ~0u;
  struct Slot {
    std::uint32_t to = none;
    PathLength length = far;
  };
  Slot& find(std::uint32_t to) {
    // Fibonacci hashing: 2654435761 is the prime next to 2³² / φ (Knuth, vol. 3, § 6.4).
    std::size_t at = (to * 2654435761u >> 7) & (slots_.size() - 1);
    while (slots_[at].to != none && slots_[at].to != to) at = (at + 1) & (slots_.size() - 1);
    return slots_[at];
  }
  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& s : old)
      if (s.to != none) find(s.to) = s;
  }
  std::vector<Slot> slots_;
  std::size_t count_ = 0;
};

}  // namespace

std::vector<PathDistances> edge_lengths(const NodeSet& nodes, const GraphStorage& graph) {
  const auto n = static_cast<std::uint32_t>(graph.node_count());
  std::vector<PathDistances> rows(n + graph.guides().size());
  parallel_for(rows.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto id = i < n ? static_cast<std::uint32_t>(i) : GraphStorage::guide_id(static_cast<std::uint32_t>(i - n));
      const auto row = graph.entries(id);
      for (std::size_t k = 0; k < row.to.size(); ++k) {
        const auto j = row.to[k];
        if (!AdjacencyRow::is_edge(row.bits[k])) continue;
        if (const auto length = graph.warped(nodes, id, j); length < unit_radius)
          rows[i].push_back({GraphStorage::is_guide(j) ? n + GraphStorage::index_of(j) : j,
                             PathLength(length) << 32 | plain_length(graph.position(nodes, id),
                                                                     graph.position(nodes, j), graph.plain_unit())});
      }
    }
  });
  return rows;
}

void BoundedDijkstra::run(std::uint32_t source, PathDistances& distances) {
  distances.clear();
  best_[source] = 0;
  heap_.assign(1, {0, source});
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
    const auto [d, u] = heap_.back();
    heap_.pop_back();
    if (d != best_[u]) continue;
    if (u != source) distances.push_back({u, d});
    for (const auto& [v, length] : edges_[u])
      if (const PathLength next = d + length; next < radius && next < best_[v]) {
        best_[v] = next;
        heap_.push_back({next, v});
        std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
      }
  }
  best_[source] = far;
  for (const auto& [v, d] : distances) best_[v] = far;
  std::sort(distances.begin(), distances.end());
}

std::vector<PathDistances> modified_floyd_warshall(const std::vector<PathDistances>& edges) {
  std::vector<SparseRow> matrix(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (const auto& [j, length] : edges[i]) matrix[i].shorten(j, length);
  std::vector<std::pair<PathLength, std::uint32_t>> through;
  for (const SparseRow& row : matrix) {
    through.clear();
    row.each([&](std::uint32_t j, PathLength length) { through.push_back({length, j}); });
    std::sort(through.begin(), through.end());
    for (const auto& [di, i] : through)
      for (const auto& [dj, j] : through) {
        if (di + dj >= radius) break;
        if (i != j) matrix[i].shorten(j, di + dj);
      }
  }
  std::vector<PathDistances> rows(edges.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    matrix[i].each([&](std::uint32_t j, PathLength length) { rows[i].push_back({j, length}); });
    std::sort(rows[i].begin(), rows[i].end());
  }
  return rows;
}

}  // namespace geo
