// § 6.3 and 6.4, with one departure: rows are recomputed on the whole graph. A detour between two nodes of P_update may
// leave P_update (its middle can be far from the cut while both ends are near), and the paper's subgraph would miss it.
#include "graph/update.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "geometry/predicates.h"

namespace geo {

GraphUpdate update_graph(const NodeSet& nodes, NodeId first_new, std::span<const NodeId> moved,
                         std::span<const std::array<Vec3, 3>> new_faces,
                         const std::function<void(const Box3&, std::vector<std::array<Vec3, 3>>&)>& obstacle_near, int k,
                         const NodeGrid& grid, VisibilityGraph& graph, Neighborhoods& rows,
                         std::span<const std::pair<NodeId, NodeId>> joins) {
  GraphUpdate result;
  const auto& x = nodes.position;
  graph.resize(nodes.size());
  rows.rows.resize(nodes.size());
  std::set<NodeId> update;
  const std::function<bool(NodeId, NodeId)> blocked = [&](NodeId a, NodeId b) {
    Box3 box{x[a.index()], x[a.index()]};
    box.add(x[b.index()]);
    std::vector<std::array<Vec3, 3>> near;
    obstacle_near(box, near);
    return std::any_of(near.begin(), near.end(), [&](const auto& t) { return segment_meets_triangle(x[a.index()], x[b.index()], t[0], t[1], t[2]); });
  };

  // E_cut, and pairs of neighbours that see each other no longer. What a face cuts has one end within half its length.
  // Support radii are at most 2²⁶ plain units when the graph is built, and new nodes take over those of old ones.
  const double reach = std::max(graph.longest(), graph.plain_unit() * 0x1p26);
  std::set<std::pair<NodeId, NodeId>> cut;
  std::vector<std::uint32_t> near;
  for (const auto& face : new_faces) {
    const Vec3 &a = face[0], &b = face[1], &c = face[2];
    const Vec3 middle = (a + b + c) / 3;
    const double size = std::sqrt(std::max({(a - middle).squaredNorm(), (b - middle).squaredNorm(), (c - middle).squaredNorm()}));
    const Box3 box = box_of(a, b, c);
    near.clear();
    grid.within(x, middle, (size + 0.5 * reach) * (1 + 1e-12), near);
    for (const auto i : near) {
      if (i >= first_new.value) continue;
      const auto crosses = [&](NodeId j) {
        Box3 segment{x[i], x[i]};
        segment.add(x[j.index()]);
        return segment.meets(box) && segment_meets_triangle(x[std::min(i, j.value)], x[std::max(i, j.value)], a, b, c);
      };
      for (const auto& arc : graph.arcs(NodeId(i)))
        if (crosses(arc.to)) cut.insert({NodeId(std::min(i, arc.to.value)), NodeId(std::max(i, arc.to.value))});
      for (const auto& n : rows.rows[i])
        if (crosses(n.to)) update.insert(NodeId(i)), update.insert(n.to);
    }
  }
  for (const NodeId m : moved) {
    update.insert(m);
    for (const auto& n : rows.rows[m.index()]) update.insert(n.to);
    for (const auto& arc : graph.arcs(m)) cut.insert({std::min(m, arc.to), std::max(m, arc.to)});
  }
  // P_update by old distances: whose shortest paths may have used a cut edge.
  for (const auto& [a, b] : cut) {
    std::uint32_t length = 0;
    for (const auto& arc : graph.arcs(a))
      if (arc.to == b) length = arc.length;
    update.insert(a), update.insert(b);
    if (length >= unit_radius) continue;
    for (const NodeId end : {a, b})
      for (const auto& n : rows.rows[end.index()])
        if (n.warped < unit_radius - length) update.insert(n.to);
  }
  for (const auto& [a, b] : cut) {
    graph.remove(a, b);
    result.cut_edges.push_back({a, b});
  }
  // E_new: each new node's k nearest visible nodes. The nearest are asked in growing numbers, since many may be hidden.
  std::vector<NodeId> fresh(moved.begin(), moved.end());
  for (std::uint32_t i = first_new.value; i < nodes.size(); ++i) fresh.push_back(NodeId(i));
  for (const NodeId i : fresh) {
    std::size_t seen = 0;
    const auto candidates = grid.nearest(x, x[i.index()], static_cast<std::size_t>(3 * k), i.value, [](auto) { return true; });
    for (const auto j : candidates) {
      if (seen == static_cast<std::size_t>(k)) break;
      if (blocked(NodeId(std::min(i.value, j)), NodeId(std::max(i.value, j)))) continue;
      ++seen;
      if (graph.add(nodes, i, NodeId(j))) result.added_edges.push_back({NodeId(std::min(i.value, j)), NodeId(std::max(i.value, j))});
    }
  }
  for (const auto& [a, b] : joins) {
    if (graph.add(nodes, a, b)) result.added_edges.push_back({a, b});
    for (const NodeId end : {a, b})
      if (end < first_new) fresh.push_back(end);  // an old node that gains an edge is a new beginning, too
  }
  std::sort(result.added_edges.begin(), result.added_edges.end());
  for (const NodeId i : fresh) {
    update.insert(i);
    for (const auto& n : neighborhood_of(i, nodes, graph, [](NodeId, NodeId) { return false; })) update.insert(n.to);
  }
  for (const NodeId i : update) rows.rows[i.index()] = neighborhood_of(i, nodes, graph, blocked);
  result.updated_nodes.assign(update.begin(), update.end());
  return result;
}

}  // namespace geo
