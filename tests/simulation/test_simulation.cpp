#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/scene_file.h"
#include "simulation/simulation.h"
#include "surface/check.h"
#include "surface/pieces.h"
#include "surface/shapes.h"

using namespace geo;

namespace {

const char* scene_text = R"(
gravity = [0, 0, -2]
[body]
mesh = "cube.ply"
spacing = 0.2
[material]
young = 3e4
damping = 0.0
[time]
frames = 6
frame_rate = 20
step = 0.025
[[blade]]
points = [[-0.4, 0, 0], [1.4, 0, 0]]
divide = 6
keys = [[0.0, 0.013, 0.507, 1.3, 0, 0, 1, 2], [0.2, 0.013, 0.511, -0.7, 0, 0, 1, 3]]
)";

}  // namespace

TEST_CASE("a scene is read, overridden, and refused with line and column") {
  const Scene s = parse_scene(scene_text, "s.toml", {{"material.young", "5e4"}, {"time.frames", "3"}});
  CHECK(s.bodies.at(0).material.young == 5e4);
  CHECK(s.frames == 3);
  REQUIRE(s.blades.size() == 1);
  CHECK(s.blades[0].points.size() == 7);
  CHECK_THROWS_WITH(parse_scene("[body]\nmesh = \"a\"\ncolour = 3\n", "s.toml"), Catch::Contains("s.toml:3:") && Catch::Contains("unknown key 'body.colour'"));
  CHECK_THROWS_WITH(parse_scene("[body]\nmesh = \"a\"\n[material]\nyoung = \"stiff\"\n", "s.toml"), Catch::Contains("s.toml:4:"));
  CHECK_THROWS_WITH(parse_scene("[body\n", "s.toml"), Catch::Contains("s.toml:1:"));
  CHECK_THROWS_AS(parse_scene("", "s.toml"), InputError);
}

TEST_CASE("a blade turns and moves by its keys") {
  Blade blade;
  blade.points = {{1, 0, 0}, {2, 0, 0}};
  blade.motion.keys = {{0, {0, 0, 0}, {0, 0, 1}, 0}, {2, {0, 0, 4}, {0, 0, 1}, 90}};
  const auto p = blade.at(1);
  CHECK(p[0].z() == Approx(2));
  CHECK(p[0].x() == Approx(std::sqrt(0.5)));
  CHECK(p[1].y() == Approx(2 * std::sqrt(0.5)));
}

TEST_CASE("a falling cube is halved and both halves go on falling as one") {
  const Scene scene = parse_scene(scene_text, "s.toml");
  Simulation sim(scene, make_block({1, 1, 1}, 0.2));
  FrameWork work;
  for (int i = 0; i < scene.frames; ++i) work += sim.advance_frame();
  CHECK(work.refused == 0);
  CHECK(find_pieces(sim.body().surface).count == 2);
  CHECK(check_body(sim.body()).first_problem == "");
  CHECK(check_complex(sim.body().surface, true).good());
  // Centre of mass on the parabola of the discrete steps.
  const auto& state = sim.state();
  double mass = 0, z = 0, rest = 0;
  for (std::size_t i = 0; i < sim.body().nodes.size(); ++i) {
    const double m = sim.solid().mass(NodeId(i));
    mass += m, z += m * state.motion.velocity[i].z(), rest += sim.body().nodes.volume[i];
  }
  CHECK(rest == Approx(1).epsilon(1e-12));
  CHECK(z / mass == Approx(-2 * 0.3).epsilon(1e-6));
  const TriangleMesh surface = sim.surface();
  CHECK(signed_volume(surface) == Approx(1).epsilon(0.05));
}
