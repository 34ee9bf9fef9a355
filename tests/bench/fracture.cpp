// kerf-bench fracture: bodies that break along cells, beside the same run without fracture: what
// breaking costs, and how that grows with the number of pieces.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>

#include "bench.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "kerf/scene.h"
#include "kerf/simulation.h"

namespace bench {
namespace {

struct Row {
  double seconds = 0, worst = 0;  // of the run, and of a frame, by the clock
  std::uint32_t pieces = 0;
  geo::FrameStats stats;
};

// A body that falls on the ground; without `cells`, as a whole.
geo::Scene thrown(const geo::TriangleMesh& model, std::size_t nodes, int cells) {
  geo::Scene scene;
  scene.bodies.resize(1);
  scene.bodies[0].sampling.count = nodes;
  scene.bodies[0].velocity = {1, 0.3, -11};
  scene.bodies[0].spin = {0, 0, 3};
  scene.material = {.young = 3e6, .density = 600, .damping = 1};
  scene.ground = true;
  scene.ground_point = {0, 0, geo::bounding_box(model).lo.z() - 0.05};
  scene.frame_rate = 120;
  scene.dt = 1.0 / 360;
  scene.frames = 36;
  scene.fracture.on = cells > 0;
  scene.fracture.cells = cells;
  scene.fracture.strength = 5e4;
  return scene;
}

// A pane in a frame that holds its rim, struck by a ball that goes through it.
geo::Scene struck_pane(int cells) {
  geo::Scene scene;
  scene.bodies.resize(1);
  scene.bodies[0].sampling.count = 20000;
  scene.material = {.young = 2e7, .density = 2000, .damping = 1};
  for (const double x : {0.0, 2.0}) scene.grips.push_back({.lo = {x - 0.08, -1, -1}, .hi = {x + 0.08, 2, 1}});
  geo::SceneObstacle ball;
  ball.mesh = geo::make_sphere(8);
  ball.scale = 0.16;
  ball.place.position = {0.9, 0.45, 0.3};
  ball.motion.keys = {{.time = 0, .position = geo::Vec3::Zero()}, {.time = 0.2, .position = {0, 0, -1.2}}};
  scene.obstacles.push_back(ball);
  scene.frame_rate = 120;
  scene.dt = 1.0 / 240;
  scene.frames = 4;
  scene.fracture.on = true;
  scene.fracture.cells = cells;
  scene.fracture.strength = 2e5;
  return scene;
}

Row run(const geo::TriangleMesh& model, const geo::Scene& scene) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  Row row;
  geo::Simulation simulation(scene, model);
  const auto start = Clock::now();
  for (int frame = 0; frame < scene.frames; ++frame) {
    const auto begin = Clock::now();
    row.stats += simulation.advance_frame();
    row.worst = std::max(row.worst, since(begin));
  }
  row.seconds = since(start);
  row.pieces = geo::find_pieces(simulation.body().surface).count;
  return row;
}

}  // namespace

int fracture(const Options& options) {
  const geo::TriangleMesh pumpkin = geo::make_pumpkin(22);
  Figures figures;
  if (!options.json)
    std::printf(
        "Two threads.\n\n| pumpkin of 2000 nodes | pieces | s | worst frame, s | fracture | mechanics | contact |\n"
        "|---|---|---|---|---|---|---|\n");
  Row whole, some;
  for (const int cells : {0, 25, 55, 110}) {
    const Row row = run(pumpkin, thrown(pumpkin, 2000, cells));
    if (cells == 0) whole = row;
    if (cells == 55) some = row;
    figures["seconds_" + std::to_string(cells)] = row.seconds;
    figures["pieces_" + std::to_string(cells)] = row.pieces;
    if (!options.json)
      std::printf("| %d cells | %u | %.1f | %.2f | %.1f | %.1f | %.1f |\n", cells, row.pieces, row.seconds, row.worst,
                  row.stats.fracture_seconds, row.stats.mechanics_seconds, row.stats.contact_seconds);
  }
  const geo::Scene pane = struck_pane(300);
  const Row through = run(geo::make_block({2, 1, 0.12}, 0.06), pane);
  figures["pane_seconds_per_frame"] = through.seconds / pane.frames;
  figures["pane_worst_frame"] = through.worst;
  figures["pane_pieces"] = through.pieces;
  figures["overhead"] = some.seconds / whole.seconds;
  if (options.json)
    print(figures, true);
  else
    std::printf(
        "\n%.1f times the run without fracture. A pane of 20000 nodes and 300 cells, struck by a ball: %u pieces, %.2f "
        "s "
        "a frame, worst %.2f s; fracture %.1f s, mechanics %.1f s, contact %.1f s.\n",
        figures["overhead"], through.pieces, figures["pane_seconds_per_frame"], through.worst,
        through.stats.fracture_seconds, through.stats.mechanics_seconds, through.stats.contact_seconds);
  return 0;
}

}  // namespace bench
