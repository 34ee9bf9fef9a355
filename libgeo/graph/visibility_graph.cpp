#include "graph/visibility_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/parallel.h"
#include "sampling/node_grid.h"

namespace geo {
namespace {

// A cell that holds about one node and a half.
double cell_for(std::span<const Vec3> positions) {
  Box3 box;
  for (const Vec3& p : positions) box.add(p);
  if (positions.size() < 2 || !(box.diagonal() > 0)) return 1;
  const Vec3 size = (box.hi - box.lo).cwiseMax(1e-3 * box.diagonal());
  return std::cbrt(1.5 * size.prod() / double(positions.size()));
}

}  // namespace

std::uint32_t warped_length(const Vec3& xi, const Vec3& xj, double ri, double rj) {
  const double d = (xi - xj).norm() / std::max(ri, rj) * double(unit_radius);
  return static_cast<std::uint32_t>(std::clamp(std::ceil(d), 1.0, 1073741824.0));
}

double plain_unit_for(const NodeSet& nodes) {
  const double most = nodes.size() == 0 ? 1.0 : *std::max_element(nodes.radius.begin(), nodes.radius.end());
  return std::exp2(std::ceil(std::log2(most)) - 26);
}

bool VisibilityGraph::has(NodeId i, NodeId j) const {
  return std::any_of(rows_[i.index()].begin(), rows_[i.index()].end(), [&](const Arc& a) { return a.to == j; });
}

bool VisibilityGraph::add(const NodeSet& nodes, NodeId i, NodeId j) {
  if (has(i, j)) return false;
  const auto length = warped_length(nodes.position[i.index()], nodes.position[j.index()], nodes.radius[i.index()], nodes.radius[j.index()]);
  const double distance = (nodes.position[i.index()] - nodes.position[j.index()]).norm();
  const auto plain = static_cast<std::uint32_t>(std::clamp(std::ceil(distance / plain_unit_), 1.0, 1073741824.0));
  const auto put = [&](NodeId from, NodeId to) {
    auto& row = rows_[from.index()];
    const Arc arc{to, length, plain};
    const auto less = [](const Arc& a, const Arc& b) { return a.length != b.length ? a.length < b.length : a.to < b.to; };
    row.insert(std::upper_bound(row.begin(), row.end(), arc, less), arc);
  };
  put(i, j), put(j, i);
  longest_ = std::max(longest_, distance);
  ++edges_;
  return true;
}

bool VisibilityGraph::remove(NodeId i, NodeId j) {
  const auto take = [&](NodeId from, NodeId to) { return std::erase_if(rows_[from.index()], [&](const Arc& a) { return a.to == to; }) > 0; };
  if (!take(i, j)) return false;
  take(j, i);
  --edges_;
  return true;
}

std::uint32_t VisibilityGraph::components(std::vector<std::uint32_t>& of) const {
  of.assign(rows_.size(), ~0u);
  std::uint32_t count = 0;
  std::vector<std::uint32_t> stack;
  for (std::uint32_t i = 0; i < rows_.size(); ++i) {
    if (of[i] != ~0u) continue;
    of[i] = count;
    stack.push_back(i);
    while (!stack.empty()) {
      const auto at = stack.back();
      stack.pop_back();
      for (const Arc& a : rows_[at])
        if (of[a.to.index()] == ~0u) of[a.to.index()] = count, stack.push_back(a.to.value);
    }
    ++count;
  }
  return count;
}

std::vector<NodeId> nearest_nodes(std::span<const Vec3> positions, int k) {
  const NodeGrid grid(cell_for(positions), positions);
  std::vector<NodeId> rows(positions.size() * static_cast<std::size_t>(k));
  parallel_for(positions.size(), 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto near = grid.nearest(positions, positions[i], static_cast<std::size_t>(k), static_cast<std::uint32_t>(i), [](auto) { return true; });
      for (std::size_t j = 0; j < near.size(); ++j) rows[i * static_cast<std::size_t>(k) + j] = NodeId(near[j]);
    }
  });
  return rows;
}

std::vector<std::pair<NodeId, NodeId>> spanning_tree(std::span<const Vec3> positions) {
  // Boruvka: each component's shortest way out, round by round. A node first asks its nearest others; only where all of
  // them are in its own component is the grid searched further.
  const std::size_t n = positions.size();
  constexpr int k = 8;
  const auto near = nearest_nodes(positions, k);
  const NodeGrid grid(cell_for(positions), positions);
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

VisibilityGraph build_visibility_graph(const NodeSet& nodes, const TriangleBvh& obstacles, int k, const Progress& progress) {
  const std::size_t n = nodes.size();
  VisibilityGraph graph;
  graph.resize(n);
  graph.set_plain_unit(plain_unit_for(nodes));
  report(progress, "nearest nodes", 0, n);
  const auto near = nearest_nodes(nodes.position, k);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::uint32_t i = 0; i < n; ++i)
    for (int q = 0; q < k; ++q)
      if (const NodeId j = near[i * static_cast<std::size_t>(k) + static_cast<std::size_t>(q)]; j.valid()) edges.push_back({std::min(i, j.value), std::max(i, j.value)});
  report(progress, "spanning tree", 0, n);
  for (const auto& [i, j] : spanning_tree(nodes.position)) edges.push_back({i.value, j.value});
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());

  report(progress, "visibility", 0, edges.size());
  std::vector<double> longest(n, 0), free(n);
  for (const auto& [i, j] : edges) {
    const double d = (nodes.position[i] - nodes.position[j]).norm();
    longest[i] = std::max(longest[i], d), longest[j] = std::max(longest[j], d);
  }
  parallel_for(n, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto c = obstacles.closest(nodes.position[i], longest[i]);
      free[i] = c.row == ~0u ? longest[i] : c.distance;
    }
  });
  std::vector<std::uint8_t> clear(edges.size());
  parallel_for(edges.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      const auto [i, j] = edges[e];
      // Two empty balls that cover the segment: nothing can block it. The margin is for rounding in the distances.
      const double d = (nodes.position[i] - nodes.position[j]).norm();
      clear[e] = d < (free[i] + free[j]) * (1 - 1e-9) || !obstacles.blocks(nodes.position[i], nodes.position[j]);
    }
  });
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (clear[e]) graph.add(nodes, NodeId(edges[e].first), NodeId(edges[e].second));
  return graph;
}

}  // namespace geo
