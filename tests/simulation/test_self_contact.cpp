#include <catch2/catch.hpp>
#include <string>

#include "kerf/contact.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "kerf/simulation.h"
#include "simulation/collisions.h"

using namespace geo;

namespace {

// A block that is cut while it is pressed together and dropped.
std::string scene_text(const std::string& young, const std::string& step) {
  return R"(
gravity = [0, 6, -9]
[body]
mesh = "cube.ply"
spacing = 0.25
[material]
young = )" +
         young + R"(
damping = 1.0
[ground]
point = [0, 0, -0.05]
stiffness = 1e4
[contact]
self = true
[time]
frames = 8
frame_rate = 24
step = )" +
         step + R"(
[[blade]]
points = [[-0.4, 0, 0], [1.4, 0, 0]]
divide = 6
keys = [[0.0, 0.013, 0.457, 1.3, 0, 0, 1, 2], [0.2, 0.013, 0.551, -0.4, 0, 0, 1, 9]]
)";
}

}  // namespace

TEST_CASE("a block that is cut while it is pressed together and dropped has no crossing in any frame") {
  const Scene scene = parse_scene(scene_text("2e4", "0.021"), "s.toml");
  Simulation sim(scene, make_block({1, 1, 1}, 0.25));
  FrameStats work;
  for (int i = 0; i < scene.frames; ++i) {
    work += sim.advance_frame();
    CHECK(count_crossings(sim.surface()) == 0);
  }
  CHECK(find_pieces(sim.body().surface).count == 2);
  CHECK(work.contact.touching > 0);
  CHECK(work.contact.held == 0);
  double lowest = 1;
  for (const Vec3& p : sim.surface().vertices) lowest = std::min(lowest, p.z());
  CHECK(lowest < -0.05);  // it lies on the ground, and presses
  CHECK(lowest > -0.12);
  // A resumed run equals one that was not stopped.
  Simulation taken_up(scene, sim.body(), sim.state());
  CHECK(taken_up.surface().vertices == sim.surface().vertices);
  taken_up.advance_frame();
  sim.advance_frame();
  CHECK(taken_up.surface().vertices == sim.surface().vertices);
}

TEST_CASE("what a crack step needs of contact before it is made counts as contact's time") {
  const Scene scene = parse_scene(scene_text("2e4", "0.021"), "s.toml");
  Body body = Simulation(scene, make_block({1, 1, 1}, 0.25)).body();
  Solid solid(body, scene.material);
  const State state{std::vector<Vec3>(solid.size(), Vec3::Zero()), std::vector<Vec3>(solid.size(), Vec3::Zero())};
  Collisions collisions(scene, body, solid, {});
  double seconds = 0;
  std::optional<EmbeddingPlan> plan;
  auto front = begin_front(std::vector<Vec3>{{-0.3, -0.3, 0.52}, {-0.3, 1.3, 0.53}}, false, 1);
  const std::vector<Vec3> next{{0.6, -0.3, 0.5}, {0.6, 1.3, 0.51}};
  CrackTransaction(body, advance_of(front, next, {}), nullptr)
      .commit(collisions.embedding_check(body, solid, state, plan, seconds));
  CHECK(seconds > 0);
  CHECK(plan.has_value());
}

TEST_CASE("nor with the time step doubled or halved, nor in softer or stiffer material", "[campaign]") {
  for (const auto& [young, step] : {std::pair{"2e4", "0.042"}, {"2e4", "0.0105"}, {"2e3", "0.021"}, {"2e5", "0.021"}}) {
    INFO(young << " Pa, " << step << " s");
    const Scene scene = parse_scene(scene_text(young, step), "s.toml");
    Simulation sim(scene, make_block({1, 1, 1}, 0.25));
    for (int i = 0; i < scene.frames; ++i) {
      sim.advance_frame();
      CHECK(count_crossings(sim.surface()) == 0);
      for (const Vec3& p : sim.surface().vertices) REQUIRE(p.allFinite());
    }
  }
}

// Two crossed blades go down into Jell-O, turning: the second crack goes across the first, whose
// sheets slide and press on each other.
TEST_CASE("no crack step is refused where soft sheets that lie on each other are cut across") {
  const Scene scene = parse_scene(R"(
gravity = [0, 0, -9.81]
[body]
mesh = "jello.ply"
nodes = 80
[material]
young = 4e4
poisson = 0.35
damping = 2.0
[ground]
point = [0, 0, -0.02]
stiffness = 4e3
[contact]
self = true
[time]
frames = 14
frame_rate = 24
step = 0.021
[[blade]]
points = [[-1.6, 0, 0], [1.6, 0.01, 0]]
divide = 32
keys = [[0.05, 1.003, 0.507, 1.15, 0, 0, 1, 12], [0.65, 1.007, 0.503, -0.15, 0, 0, 1, 72]]
[[blade]]
points = [[0, -1.6, 0], [0.01, 1.6, 0]]
divide = 32
keys = [[0.07, 1.003, 0.507, 1.15, 0, 0, 1, 12], [0.67, 1.007, 0.503, -0.15, 0, 0, 1, 72]]
)",
                                  "s.toml");
  Simulation sim(scene, make_block({2, 1, 1}, 0.25));
  for (int i = 0; i < scene.frames; ++i) {
    CHECK(sim.advance_frame().refused == 0);
    CHECK(count_crossings(sim.surface()) == 0);
  }
}
