#include "graph/guides.h"

#include <algorithm>

#include "kerf/parallel.h"

namespace geo {
namespace {

bool in_reach(const Vec3& a, const Vec3& b, double radius) { return squared_distance(a, b) <= radius * radius; }

constexpr double more = 1 + 1e-9;  // grids are asked for so much more: in_reach() decides

}  // namespace

void near_guide(const NodeSet& nodes, const NodeGrid& grid, const VisibilityGraph& graph, std::uint32_t guide,
                std::vector<std::uint32_t>& ids) {
  const Vec3& p = graph.position(nodes, guide);
  const double radius = graph.radius(nodes, guide);
  std::vector<std::uint32_t> found;
  grid.within(nodes.position, p, more * radius, found);
  for (const auto i : found)
    if (in_reach(p, nodes.position[i], radius)) ids.push_back(i);
  found.clear();
  graph.guides().within(p, more * graph.guides().largest_radius(), found);
  for (const auto g : found) {
    const auto id = VisibilityGraph::first_guide + g;
    if (id < guide && !graph.guides().retired(g) &&
        in_reach(p, graph.guides().position(g), std::max(radius, graph.guides().radius(g))))
      ids.push_back(id);
  }
}

void guides_near(const NodeSet& nodes, const VisibilityGraph& graph, std::uint32_t node,
                 std::vector<std::uint32_t>& ids) {
  const Vec3& p = nodes.position[node];
  std::vector<std::uint32_t> found;
  graph.guides().within(p, more * graph.guides().largest_radius(), found);
  for (const auto g : found)
    if (!graph.guides().retired(g) && in_reach(p, graph.guides().position(g), graph.guides().radius(g)))
      ids.push_back(VisibilityGraph::first_guide + g);
}

void join_guides(const NodeSet& nodes, std::span<const std::vector<std::uint32_t>> seen, VisibilityGraph& graph) {
  auto guide = static_cast<std::uint32_t>(VisibilityGraph::first_guide + graph.guides().size() - seen.size());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& row : seen) {
    for (const auto id : row) edges.push_back({guide, id}), edges.push_back({id, guide});
    ++guide;
  }
  std::sort(edges.begin(), edges.end());
  graph.append_guide_edges(nodes, edges);
}

void add_guides(const NodeSet& nodes, const NodeGrid& grid, const TriangleBvh& obstacles, std::span<const Guide> guides,
                VisibilityGraph& graph) {
  const auto first = VisibilityGraph::first_guide + graph.guides().size();
  for (const Guide& guide : guides) graph.add_guide(guide);
  std::vector<std::vector<std::uint32_t>> seen(guides.size());
  parallel_for(guides.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      const auto id = static_cast<std::uint32_t>(first + g);
      near_guide(nodes, grid, graph, id, seen[g]);
      std::erase_if(seen[g], [&](std::uint32_t other) {
        return obstacles.blocks(graph.position(nodes, other), graph.position(nodes, id));
      });
    }
  });
  join_guides(nodes, seen, graph);
}

}  // namespace geo
