// Scenes by Bossak's scheme: resumed runs, energy over impacts, and contact as it is with backward
// Euler.
#include <algorithm>
#include <catch2/catch.hpp>

#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "kerf/simulation.h"
#include "simulation/kept_run.h"

using namespace geo;

namespace {

// A cube that is thrown, cut in flight, and strikes the ground.
const char* thrown_text = R"(
[body]
mesh = "cube.ply"
spacing = 0.25
position = [0, 0, 0.3]
velocity = [0.5, 0, 2]
spin = [0, 3, 0]
[material]
young = 1e5
[ground]
[time]
frames = 30
frame_rate = 24
integrator = "bossak"
[[blade]]
points = [[-1, 0.47, 0], [3, 0.53, 0]]
divide = 12
keys = [[0.1, 0, 0, 3, 0, 0, 1, 1], [0.25, 0, 0, -1, 0, 0, 1, 1]]
)";

std::size_t smooth_nodes(const Simulation& sim) {
  const std::vector<std::uint8_t>& smooth = sim.state().motion.smooth;
  return static_cast<std::size_t>(std::count(smooth.begin(), smooth.end(), 1));
}

}  // namespace

TEST_CASE("a run by Bossak's scheme is resumed to the same bytes, in flight, in a cut and on the ground", "[bossak]") {
  const Scene scene = parse_scene(thrown_text, "s.toml");
  CHECK(scene.integrator() == "bossak");
  Simulation sim(scene, make_block({1, 1, 1}, 0.25));
  std::vector<std::string> kept;
  std::size_t flying = 0, touching = 0;
  for (int f = 0; f < scene.frames; ++f) {
    sim.advance_frame();
    kept.push_back(bytes(sim));
    const std::size_t smooth = smooth_nodes(sim);
    flying += smooth == sim.body().nodes.size();
    touching += smooth < sim.body().nodes.size();
  }
  CHECK(find_pieces(sim.body().surface).count == 2);
  CHECK((flying > 1 && touching > 1));
  for (const std::size_t from : {1u, 5u, 14u, 24u}) {
    INFO("resumed after frame " << from);
    Simulation resumed = read_back(scene, kept[from - 1]);
    for (std::size_t f = from; f < from + 4; ++f) {
      resumed.advance_frame();
      CHECK(bytes(resumed) == kept[f]);
    }
  }
}

TEST_CASE("no impact gives a body energy in steps of Bossak's scheme", "[bossak]") {
  const Scene scene = parse_scene(thrown_text, "s.toml");
  Simulation sim(scene, make_block({1, 1, 1}, 0.25));
  const auto total = [](const FrameStats& s) { return s.kinetic + s.energy + s.weight; };
  double highest = 0, last = 0, begin = 0;
  for (std::uint32_t i = 0; i < sim.body().nodes.size(); ++i)
    begin += 0.5 * sim.solid().mass(NodeId(i)) * sim.state().motion.velocity[i].squaredNorm();
  for (int f = 0; f < scene.frames; ++f) {
    const FrameStats stats = sim.advance_frame();
    last = total(stats);
    highest = std::max(highest, last);
  }
  INFO("from " << begin << " J to " << last << " J, at most " << highest << " J");
  CHECK(highest < 1.002 * begin);
  CHECK(last < begin);
}

TEST_CASE("what something touches makes the same steps as with backward Euler", "[bossak]") {
  const std::string text =
      "[body]\nmesh = 'a'\nspacing = 0.25\n[material]\nyoung = 1e5\n[ground]\n[time]\nframe_rate = 24\n"
      "[[blade]]\npoints = [[-0.4, 0.5, 0], [1.4, 0.52, 0]]\ndivide = 6\n"
      "keys = [[0.1, 0, 0, 1.3, 0, 0, 1, 1], [0.3, 0, 0, -0.3, 0, 0, 1, 1]]\n";
  const Scene euler = parse_scene(text, "s.toml"),
              bossak = parse_scene(text, "s.toml", {{"time.integrator", "\"bossak\""}});
  Simulation one(euler, make_block({1, 1, 1}, 0.25)), other(bossak, make_block({1, 1, 1}, 0.25));
  for (int f = 0; f < 10; ++f) {
    one.advance_frame();
    other.advance_frame();
    CHECK(smooth_nodes(other) == 0);
    REQUIRE(one.state().motion.displacement == other.state().motion.displacement);
    REQUIRE(one.state().surface == other.state().surface);
  }
  CHECK(find_pieces(other.body().surface).count == 2);
}
