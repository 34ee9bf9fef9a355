// Octrees over nodes and guides give the pairs within a support radius; exact segment tests against
// the faces decide which of them see each other.
#include "graph/guide_edges.h"

#include <algorithm>

#include "graph/graph_storage.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

bool within(const Vec3& a, const Vec3& b, double radius) { return squared_distance(a, b) <= radius * radius; }

// Grids are queried with a margin for rounding; within() decides.
constexpr double margin = 1 + 1e-9;

}  // namespace

void ids_near_guide(const NodeSet& nodes, const NodeGrid& grid, const GraphStorage& graph, std::uint32_t guide,
                    std::vector<std::uint32_t>& ids) {
  const Vec3& p = graph.position(nodes, guide);
  const double radius = graph.radius(nodes, guide);
  std::vector<std::uint32_t> found;
  grid.within(nodes.position, p, margin * radius, found);
  for (const auto i : found)
    if (within(p, nodes.position[i], radius)) ids.push_back(i);
  found.clear();
  const GuideSet& guides = graph.guides();
  guides.within(p, margin * guides.largest_radius(), found);
  for (const auto g : found) {
    const auto id = GraphStorage::guide_id(g);
    if (id < guide && !guides.retired(g) && within(p, guides.position(g), std::max(radius, guides.radius(g))))
      ids.push_back(id);
  }
}

void guides_near(const NodeSet& nodes, const GraphStorage& graph, std::uint32_t node, std::vector<std::uint32_t>& ids) {
  const Vec3& p = nodes.position[node];
  const GuideSet& guides = graph.guides();
  std::vector<std::uint32_t> found;
  guides.within(p, margin * guides.largest_radius(), found);
  for (const auto g : found)
    if (!guides.retired(g) && within(p, guides.position(g), guides.radius(g))) ids.push_back(GraphStorage::guide_id(g));
}

void add_guide_edges(const NodeSet& nodes, std::span<const std::vector<std::uint32_t>> visible, GraphStorage& graph) {
  auto guide = GraphStorage::guide_id(graph.guides().size() - static_cast<std::uint32_t>(visible.size()));
  std::vector<std::pair<std::uint32_t, std::uint32_t>> half_edges;
  for (const auto& ids : visible) {
    for (const auto id : ids) {
      half_edges.push_back({guide, id});
      half_edges.push_back({id, guide});
    }
    ++guide;
  }
  std::sort(half_edges.begin(), half_edges.end());
  graph.append_guide_edges(nodes, half_edges);
}

void add_guides(const NodeSet& nodes, const NodeGrid& grid, const TriangleBvh& obstacles, std::span<const Guide> guides,
                VisibilityGraph& visibility_graph) {
  GraphStorage& graph = GraphStorage::of(visibility_graph);
  const auto first = GraphStorage::guide_id(graph.guides().size());
  for (const Guide& guide : guides) graph.add_guide(guide);
  std::vector<std::vector<std::uint32_t>> visible(guides.size());
  parallel_for(guides.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      const auto id = static_cast<std::uint32_t>(first + g);
      ids_near_guide(nodes, grid, graph, id, visible[g]);
      std::erase_if(visible[g], [&](std::uint32_t other) {
        return obstacles.blocks(graph.position(nodes, other), graph.position(nodes, id));
      });
    }
  });
  add_guide_edges(nodes, visible, graph);
}

}  // namespace geo
