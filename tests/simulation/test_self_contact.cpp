#include <catch2/catch.hpp>

#include "contact/crossing.h"
#include "io/scene_file.h"
#include "simulation/simulation.h"
#include "surface/pieces.h"
#include "surface/shapes.h"

using namespace geo;

TEST_CASE("a block that is cut while it is pressed together and dropped has no crossing in any frame") {
  const char* text = R"(
gravity = [0, 6, -9]
[body]
mesh = "cube.ply"
spacing = 0.25
[material]
young = 2e4
damping = 1.0
[ground]
point = [0, 0, -0.05]
stiffness = 1e4
[contact]
self = true
[time]
frames = 8
frame_rate = 24
step = 0.021
[[blade]]
points = [[-0.4, 0, 0], [1.4, 0, 0]]
divide = 6
keys = [[0.0, 0.013, 0.457, 1.3, 0, 0, 1, 2], [0.2, 0.013, 0.551, -0.4, 0, 0, 1, 9]]
)";
  const Scene scene = parse_scene(text, "s.toml");
  Simulation sim(scene, make_block({1, 1, 1}, 0.25));
  FrameWork work;
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
  // Two that are taken up from what a checkpoint holds go on the same, as a run does from each of its checkpoints.
  Simulation one(scene, sim.body(), sim.state()), other(scene, sim.body(), sim.state());
  CHECK(one.surface().vertices == sim.surface().vertices);
  one.advance_frame(), other.advance_frame();
  CHECK(one.surface().vertices == other.surface().vertices);
}
