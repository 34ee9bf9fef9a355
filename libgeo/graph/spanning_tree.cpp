#include "graph/spanning_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "graph/nearest.h"
#include "sampling/node_grid.h"

namespace geo {
static double grid_cell_for(std::span<const Vec3> positions) {
  Box3 box;
  for (const Vec3& p : positions) box.add(p);
  if (positions.size() < 2 || !(box.diagonal() > 0)) return 1;
  const Vec3 size = (box.hi - box.lo).cwiseMax(1e-3 * box.diagonal());
  return std::cbrt(1.5 * size.prod() / double(positions.size()));
}
std::vector<std::pair<NodeId, NodeId>> spanning_tree(std::span<const Vec3> positions) {
  // Boruvka: each component's shortest way out, round by round. A node first asks its nearest others; only where all of
  // them are in its own component is the grid searched further.
  const std::size_t n = positions.size();
  constexpr int k = 8;
  const auto near = nearest_nodes(positions, k);
  const NodeGrid grid(grid_cell_for(positions), positions);
  std::vector<std::uint32_t> root(n);
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  struct Way {
    double length = std::numeric_limits<double>::infinity();
    std::uint32_t i = ~0u, j = ~0u;
    bool operator<(const Way& o) const { return length != o.length ? length < o.length : i != o.i ? i < o.i : j < o.j; }
  };
  std::vector<std::pair<NodeId, NodeId>> tree;
  while (tree.size() + 1 < n) {
    std::vector<std::uint32_t> component(n);
    for (std::uint32_t i = 0; i < n; ++i) component[i] = find(i);
    std::vector<Way> best(n);
    for (std::uint32_t i = 0; i < n; ++i) {
      std::uint32_t j = ~0u;
      for (int q = 0; q < k && j == ~0u; ++q)
        if (const NodeId c = near[i * k + static_cast<std::size_t>(q)]; c.valid() && component[c.index()] != component[i]) j = c.value;
      Way& way = best[component[i]];
      if (j == ~0u) {
        const NodeId farthest = near[i * k + k - 1];
        // Nothing closer than its k-th nearest leads out; skip the search when the component knows a shorter way.
        if (farthest.valid() && (positions[farthest.index()] - positions[i]).squaredNorm() > way.length) continue;
        const auto out = grid.nearest(positions, positions[i], 1, i, [&](std::uint32_t r) { return component[r] != component[i]; });
        if (out.empty()) continue;
        j = out[0];
      }
      const Way mine{(positions[i] - positions[j]).squaredNorm(), std::min(i, j), std::max(i, j)};
      if (mine < way) way = mine;
    }
    for (std::uint32_t c = 0; c < n; ++c) {
      const Way& way = best[c];
      if (way.i == ~0u || find(way.i) == find(way.j)) continue;
      root[std::max(find(way.i), find(way.j))] = std::min(find(way.i), find(way.j));
      tree.push_back({NodeId(way.i), NodeId(way.j)});
    }
  }
  std::sort(tree.begin(), tree.end());
  return tree;
}

}  // namespace geo
