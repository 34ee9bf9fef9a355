// Distances around concave edges, with guides and without, beside the shortest paths; and what
// guides cost (§ 8).
#include <cstdio>

#include "graph.h"
#include "graph/build_graph.h"
#include "graph/concave_shapes.h"
#include "graph/guide_edges.h"
#include "graph/guide_placement.h"
#include "graph/update.h"
#include "kerf/graph.h"
#include "kerf/parallel.h"

namespace bench {
namespace {

using geo::NodeId;
using Soup = std::vector<std::array<geo::Vec3, 3>>;

// Pairs that do not see each other and whose shortest path is shorter than the support.
ConcaveErrors errors_of(const Prism& prism, const geo::NodeSet& nodes, const std::vector<geo::Guide>& guides) {
  const geo::TriangleBvh tree(geo::corners_of(walls_of(prism)));
  const PrismPaths paths(prism);
  // Supports of twice the size: rows tell distances of those, too, that ought to be neighbours and
  // are not.
  geo::NodeSet wide = nodes;
  for (double& r : wide.radius) r *= 2;
  auto graph = geo::build_visibility_graph(wide, tree, 26);
  geo::add_guides(wide, geo::NodeGrid(nodes.spacing[0], wide.position), tree, guides, graph);
  geo::build_neighborhoods(wide, graph, tree);
  ConcaveErrors errors;
  for (std::uint32_t i = 0; i < nodes.size(); ++i)
    for (const auto& n : graph.neighbors(wide, NodeId(i))) {
      if (n.to.value < i) continue;
      const double exact = paths.length(nodes.position[i], nodes.position[n.to.index()]);
      if (exact < nodes.radius[i] && tree.blocks(nodes.position[i], nodes.position[n.to.index()]))
        errors.add(n.distance, exact, nodes.radius[i]);
    }
  return errors;
}

void measure_errors(const Options& options, Figures& figures) {
  constexpr int across = 24;
  if (!options.json) {
    std::printf(
        "distances of pairs that do not see each other, %d nodes a unit; error: longer than the shortest path; missed: "
        "no neighbours, but ought to be\n",
        across);
    std::printf("  %-8s %-22s %7s %8s %8s %8s %9s\n", "", "", "pairs", "mean", "worst", "missed", "guides");
  }
  for (const auto& prism : concave_prisms()) {
    const auto nodes = nodes_in(prism, across, 11);
    const auto mesh = walls_of(prism);
    const geo::NodeGrid grid(nodes.spacing[0], nodes.position);
    const geo::TriangleBvh tree(geo::corners_of(mesh));
    const auto blocked = [&](const geo::Vec3& p, const geo::Vec3& q) { return tree.blocks(p, q); };
    const auto show = [&](const char* what, const ConcaveErrors& e, std::size_t guides) {
      if (options.json) return;
      std::printf("  %-8s %-22s %7zu %7.2f%% %7.2f%% %7.2f%% %9zu\n", prism.name.c_str(), what, e.count, 100 * e.mean(),
                  100 * e.worst, 100.0 * double(e.missed) / double(e.count), guides);
    };
    const auto bare = errors_of(prism, nodes, {});
    show("without", bare, 0);
    for (const double spacing : {2.0, 1.0, 0.5, 0.25}) {
      if (options.json && spacing != geo::GuideOptions().spacing) continue;
      const auto guides = geo::place_guides(edges_of(mesh), nodes, grid, blocked, {.spacing = spacing});
      const auto with = errors_of(prism, nodes, guides);
      char what[64];
      std::snprintf(what, sizeof what, "guides %g spacings apart", spacing);
      show(what, with, guides.size());
      if (spacing != geo::GuideOptions().spacing) continue;
      figures["concave_mean_error_" + prism.name] = bare.mean();
      figures["concave_worst_error_" + prism.name] = bare.worst;
      figures["concave_mean_error_guided_" + prism.name] = with.mean();
      figures["concave_worst_error_guided_" + prism.name] = with.worst;
      figures["concave_missed_" + prism.name] = double(bare.missed) / double(bare.count);
      figures["concave_missed_guided_" + prism.name] = double(with.missed) / double(with.count);
      for (const auto& [key, value] : {std::pair("concave_mean_error", bare.mean()),
                                       {"concave_worst_error", bare.worst},
                                       {"concave_mean_error_guided", with.mean()},
                                       {"concave_worst_error_guided", with.worst}})
        figures[key] = std::max(figures[key], value);
    }
  }
}

// The ribbed ball with its slit, whose tip is one long concave edge, and a crack in it.
void measure_cost(std::size_t count, const Options& options, Figures& figures) {
  const GraphCase c = make_graph_case(count);
  const double n = double(c.nodes.size()), h = c.spacing;
  const Soup surface = geo::corners_of(c.surface);
  const geo::TriangleBvh tree(surface);
  const geo::NodeGrid grid(h, c.nodes.position);
  const auto surface_edges = edges_of(c.surface);
  const auto blocked = [&](const geo::Vec3& p, const geo::Vec3& q) { return tree.blocks(p, q); };
  const auto near = [&](const geo::Box3& box, Soup& out) {
    std::vector<std::uint32_t> rows;
    tree.near(box, rows);
    for (const auto r : rows) out.push_back(surface[r]);
  };
  // A square of 16 by 16 spacings, and guides half a spacing apart ahead of its sides.
  const geo::Vec3 middle(-0.4, 0.1, 0), u = geo::Vec3(0.3, 0.9, 0.1).normalized(),
                                        v = u.cross(geo::Vec3(1, 0.2, 0.1)).normalized();
  const auto point = [&](double s, double t) { return geo::Vec3(middle + 16 * h * ((s - 0.5) * u + (t - 0.5) * v)); };
  Soup crack;
  for (int k = 0; k < 16; ++k) {
    const double s0 = k / 16.0, s1 = (k + 1) / 16.0;
    crack.push_back({point(s0, 0), point(s1, 0), point(s1, 1)});
    crack.push_back({point(s0, 0), point(s1, 1), point(s0, 1)});
  }
  std::vector<geo::Guide> front;
  for (int k = 0; k < 32; ++k)
    for (int side = 0; side < 4; ++side) {
      const double t = (k + 0.5) / 32, ahead = side % 2 ? 1 + 1.0 / 1024 : -1.0 / 1024;
      front.push_back({side < 2 ? point(ahead, t) : point(t, ahead), c.nodes.radius[0]});
    }

  const int before = geo::threads();
  geo::set_threads(1);
  geo::VisibilityGraph graph, whole[2];
  double place = 1e300, edges[2] = {1e300, 1e300}, rows[2] = {1e300, 1e300}, update[2] = {1e300, 1e300};
  std::size_t guides = 0, updated[2] = {};
  const auto timed = [](double& best, const auto& work) {
    const double start = cpu_seconds();
    work();
    best = std::min(best, cpu_seconds() - start);
  };
  // Both in turn, so that what else the machine does concerns both.
  for (int run = 0; run < 7; ++run)
    for (int with = 0; with < 2; ++with) {
      std::vector<geo::Guide> placed;
      if (with) timed(place, [&] { placed = geo::place_guides(surface_edges, c.nodes, grid, blocked); });
      guides = placed.size();
      timed(edges[with], [&] {
        graph = geo::build_visibility_graph(c.nodes, tree, 26);
        geo::add_guides(c.nodes, grid, tree, placed, graph);
      });
      timed(rows[with], [&] { geo::build_neighborhoods(c.nodes, graph, tree); });
      whole[with] = graph;
      timed(update[with], [&] {
        const auto result = geo::update_graph({.nodes = c.nodes,
                                               .grid = grid,
                                               .first_new = NodeId(c.nodes.size()),
                                               .k = 26,
                                               .triangles_near = near,
                                               .new_faces = crack,
                                               .guides = {with ? front : std::vector<geo::Guide>(), {}}},
                                              graph);
        updated[with] = result.updated_nodes.size();
      });
    }
  const double bytes[] = {double(whole[0].bytes()) / n, double(whole[1].bytes()) / n};
  geo::set_threads(before);
  figures["nodes"] = n;
  figures["guides"] = double(guides);
  figures["concave_bytes_per_node"] = bytes[0];
  figures["concave_bytes_per_node_guided"] = bytes[1];
  figures["concave_graph_seconds"] = edges[0];
  figures["concave_graph_seconds_guided"] = edges[1] + place;
  figures["concave_rows_seconds"] = rows[0];
  figures["concave_rows_seconds_guided"] = rows[1];
  figures["concave_update_seconds"] = update[0];
  figures["concave_update_seconds_guided"] = update[1];
  if (options.json) return;
  std::printf("the cost, %zu nodes in a ribbed ball with a slit to its axis, %zu guides\n", c.nodes.size(), guides);
  std::printf("  %-44s %10s %10s\n", "", "without", "with");
  std::printf("  %-44s %10.1f %10.1f\n", "rows, bytes a node", bytes[0], bytes[1]);
  std::printf("  %-44s %10.2f %10.2f\n", "edges, ms", 1e3 * edges[0], 1e3 * (edges[1] + place));
  std::printf("  %-44s %10.2f %10.2f\n", "neighbourhoods, ms", 1e3 * rows[0], 1e3 * rows[1]);
  std::printf("  %-44s %10.3f %10.3f\n", "a crack of 16 x 16 spacings, ms", 1e3 * update[0], 1e3 * update[1]);
  std::printf("  %-44s %10zu %10zu\n", "rows found anew for it", updated[0], updated[1]);
}

}  // namespace

int concave(const Options& options) {
  Figures errors;
  measure_errors(options, errors);
  for (const std::size_t count : options.nodes) {
    Figures figures = errors;
    measure_cost(count, options, figures);
    print(figures, options.json);
  }
  return 0;
}

}  // namespace bench
