// Updates of graph and rows beside a full rebuild (§ 6.3).
#include <chrono>
#include <cstdio>

#include "geometry/bvh.h"
#include "graph.h"
#include "graph/build_graph.h"
#include "graph/update.h"
#include "kerf/graph.h"
#include "kerf/parallel.h"

namespace bench {
namespace {

using Soup = std::vector<std::array<geo::Vec3, 3>>;

// A strip of a plane through the middle of the body, from share `from` to share `to` of the way
// across: `columns` quads.
Soup strip(const geo::Vec3& at, double width, double from, double to, int columns) {
  const geo::Vec3 normal = geo::Vec3(0.96, 0.25, 0.12).normalized(), u = normal.cross(geo::Vec3(0, 0, 1)).normalized(),
                  v = normal.cross(u);
  const auto point = [&](double s, double t) { return geo::Vec3(at + width * ((s - 0.5) * u + (t - 0.5) * v)); };
  Soup faces;
  for (int k = 0; k < columns; ++k) {
    const double t0 = double(k) / columns, t1 = double(k + 1) / columns;
    faces.push_back({point(from, t0), point(to, t0), point(to, t1)});
    faces.push_back({point(from, t0), point(to, t1), point(from, t1)});
  }
  return faces;
}

}  // namespace

void measure_update(const GraphCase& c, const Options& options, Figures& figures) {
  const int before = geo::threads();
  geo::set_threads(1);
  const Soup surface = geo::corners_of(c.surface);
  const geo::TriangleBvh tree(surface);
  const geo::NodeGrid grid(c.spacing, c.nodes.position);
  const auto near = [&](const geo::Box3& box, Soup& out) {
    std::vector<std::uint32_t> rows;
    tree.near(box, rows);
    for (const auto r : rows) out.push_back(surface[r]);
  };
  geo::VisibilityGraph whole, graph;
  const auto build = [&] {
    whole = geo::build_visibility_graph(c.nodes, tree, 26);
    geo::build_neighborhoods(c.nodes, whole, tree);
  };
  std::size_t cut = 0, updated = 0;
  const auto step = [&](const Soup& faces) {
    const double start = cpu_seconds();
    const auto update = geo::update_graph({.nodes = c.nodes,
                                           .grid = grid,
                                           .first_new = geo::NodeId(c.nodes.size()),
                                           .k = 26,
                                           .triangles_near = near,
                                           .new_faces = faces},
                                          graph);
    const double seconds = cpu_seconds() - start;
    cut += update.cut_edges.size();
    updated += update.updated_nodes.size();
    return seconds;
  };

  // In twelve steps through all of it; builds in turn with them, so that both meet a moment in
  // which the machine does nothing else.
  constexpr int steps = 12;
  double rebuild = 1e300;
  std::vector<double> least_of(steps, 1e300);
  for (int run = 0; run < 9; ++run) {
    if (run % 3 == 0) rebuild = std::min(rebuild, least([] {}, build, 1));
    graph = whole;
    cut = updated = 0;
    for (int s = 0; s < steps; ++s)
      least_of[std::size_t(s)] = std::min(least_of[std::size_t(s)],
                                          step(strip({-0.2, 0, 0}, 2.3, double(s) / steps, double(s + 1) / steps, 40)));
  }
  const double worst = *std::max_element(least_of.begin(), least_of.end());
  double total = 0;
  for (const double s : least_of) total += s;
  const std::size_t total_cut = cut, total_updated = updated;

  // Sixteen spacings across, with the same number of nodes around it whatever the size of the body.
  double fixed = 1e300;
  for (int run = 0; run < 9; ++run) {
    graph = whole;
    cut = updated = 0;
    fixed = std::min(fixed, step(strip({-0.4, 0.1, 0}, 16 * c.spacing, 0, 1, 16)));
  }
  geo::set_threads(before);

  figures["rebuild_seconds"] = rebuild;
  figures["worst_step_seconds"] = worst;
  figures["worst_step_vs_rebuild"] = worst / rebuild;
  figures["step_seconds_total"] = total;
  figures["fixed_crack_seconds"] = fixed;
  if (options.json) return;
  std::printf("  updates of graph and rows; built from nothing in %.1f ms\n", 1e3 * rebuild);
  std::printf("    twelve steps through the body   %8.2f ms, %zu edges cut, %zu rows found anew (%.0f ns each)\n",
              1e3 * total, total_cut, total_updated, 1e9 * total / double(total_updated));
  std::printf("    the worst of them               %8.2f ms, %.2f %% of a build\n", 1e3 * worst, 100 * worst / rebuild);
  std::printf("    a crack of 16 x 16 spacings     %8.3f ms, %zu edges cut, %zu rows\n", 1e3 * fixed, cut, updated);
}

}  // namespace bench
