// Threads that sew two places of the bodies together.
#include <catch2/catch.hpp>

#include <random>
#include <sstream>

#include "cases.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/simulation.h"
#include "simulation/kept_run.h"
#include "simulation/stitches.h"

using namespace geo;

namespace {

Scene two_blocks(const std::string& more = "") {
  return parse_scene(R"(
gravity = [0, 0, 0]
[[body]]
mesh = "a.ply"
spacing = 0.25
[[body]]
mesh = "b.ply"
spacing = 0.25
[material]
young = 3e4
damping = 6.0
[contact]
self = false
[time]
frame_rate = 20
step = 0.05
)" + more,
                     "s.toml");
}

// Two unit cubes, the second one 0.5 behind the first along x.
PlacedModels placed(const Scene& scene) {
  TriangleMesh second = make_block({1, 1, 1}, 0.25);
  for (Vec3& p : second.vertices) p.x() += 1.5;
  return place_models(scene, {make_block({1, 1, 1}, 0.25), second});
}

Stitch thread(double length, double closing) {
  Stitch stitch;
  stitch.ends[0].point = {0.9, 0.5, 0.5};
  stitch.ends[1].point = {1.6, 0.5, 0.5};
  stitch.stiffness = 2e4;
  stitch.length = length;
  stitch.closing = closing;
  return stitch;
}

// Momentum of both bodies over the sum of those of their nodes, which is above zero.
double drift_of(const Simulation& run) {
  Vec3 sum = Vec3::Zero();
  double all = 1e-9;
  const Solid& solid = run.solid();
  for (std::uint32_t i = 0; i < solid.size(); ++i) {
    const Vec3 momentum = solid.mass(NodeId(i)) * run.state().motion.velocity[i];
    sum += momentum;
    all += momentum.norm();
  }
  return sum.norm() / all;
}

double apart(const Simulation& run, const Stitch& stitch) {
  return distance_of_ends(stitch, run.body(), run.solid(), run.state().motion.displacement);
}

}  // namespace

TEST_CASE("a stitch draws two bodies to its length, and conserves their momentum", "[stitches]") {
  for (const bool implicit : {true, false}) {
    Scene scene = two_blocks();
    scene.implicit = implicit;
    Simulation run(scene, placed(scene));
    const Stitch stitch = thread(0.5, 1);
    CHECK(apart(run, stitch) == Approx(0.7));
    run.add_stitch(stitch);
    CHECK(run.scene().stitches[0].slack.value() == Approx(0.7));
    double drawn = 0, largest = 0, drift = 0;
    for (int i = 0; i < 100; ++i) {
      const FrameStats stats = run.advance_frame();
      REQUIRE(stats.stitch_force.size() == 1);
      largest = std::max(largest, stats.stitch_force[0]);
      drawn += stats.work;
      if (i == 10) drift = drift_of(run);  // they move fast
    }
    CAPTURE(implicit, largest, drawn, drift);
    CHECK(apart(run, stitch) < 0.51);
    CHECK(largest > 0);
    CHECK(drawn > 0);
    CHECK(drift < (implicit ? 0.02 : 1e-9));  // implicit steps end at their accuracy
  }
}

TEST_CASE("a stitch bears tension alone", "[stitches]") {
  const Scene scene = two_blocks();
  Simulation run(scene, placed(scene));
  run.add_stitch(thread(0.9, 0));  // longer than its ends are apart
  for (int i = 0; i < 10; ++i) CHECK(run.advance_frame().stitch_force.at(0) == 0);
  for (const Vec3& u : run.state().motion.displacement) CHECK(u.norm() < 1e-12);
}

TEST_CASE("the work of a stitch is the energy that it leaves in bodies and thread", "[stitches]") {
  Scene scene = two_blocks(R"(
[[grip]]
box = [-1, -1, -1, 0.1, 2, 2]
[[grip]]
box = [2.4, -1, -1, 3, 2, 2]
)");
  scene.accuracy = 1e-5;
  scene.material.damping = 1;  // takes little of so slow a motion
  Simulation run(scene, placed(scene));
  const Stitch stitch = thread(0.4, 5);  // slowly, so that little moves
  run.add_stitch(stitch);
  double work = 0;
  FrameStats stats;
  for (int i = 0; i < 100; ++i) {
    stats = run.advance_frame();
    work += stats.work;
  }
  const double stretch = apart(run, stitch) - 0.4;
  const double stored = stats.energy + 0.5 * stitch.stiffness * stretch * stretch;
  CAPTURE(work, stats.energy, stored, stretch);
  CHECK(stats.energy > 0);
  // Steps take the tension at their end: half of a step's growth of it, in a hundred steps.
  CHECK(work == Approx(stored).epsilon(0.05));
}

TEST_CASE("the derivatives of a thread are those of its energy", "[stitches]") {
  const Scene scene = two_blocks();
  Simulation run(scene, placed(scene));
  const Seeds all = seeds(20);
  for (int i = 0; i < all.count; ++i) {
    const std::uint64_t seed = all.first + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> dice(-0.3, 0.3);
    CAPTURE(seed);
    StitchPotential potential;
    const Stitch stitch = thread(seed % 2 == 0 ? 0 : 0.45, 0);
    potential.begin_step({stitch}, run.body(), run.solid(), 0, 0.05);
    potential.begin_substep({}, 0, 1);
    REQUIRE(potential.size() == 1);
    const Vec3 d(dice(random), dice(random), dice(random));
    const auto at = potential.derivatives(0, d);
    constexpr double h = 1e-6;
    for (int k = 0; k < 3; ++k) {
      const Vec3 e = h * Vec3::Unit(k);
      const double slope = (potential.energy(0, d + e) - potential.energy(0, d - e)) / (2 * h);
      CHECK(-at.force[k] == Approx(slope).margin(1e-3));
      const Vec3 bend = (potential.derivatives(0, d - e).force - potential.derivatives(0, d + e).force) / (2 * h);
      for (int j = 0; j < 3; ++j) CHECK(at.hessian(j, k) == Approx(bend[j]).margin(1e-2));
    }
  }
}

TEST_CASE("a run with a stitch that was added and cut is the run of its recording", "[stitches]") {
  const Scene scene = two_blocks();
  const auto frames = [](Simulation& run, int n) {
    for (int i = 0; i < n; ++i) run.advance_frame();
  };
  Simulation run(scene, placed(scene));
  frames(run, 2);
  Stitch stitch = thread(0, 0.5);
  stitch.ends[0].node = 3;
  auto made = run.add_stitch(stitch);
  CHECK(made.index() == 0);
  frames(run, 8);
  run.stitch(0).end();
  frames(run, 5);
  CHECK(run.advance_frame().stitch_force.at(0) == 0);
  std::ostringstream text;
  write_scene(text, recording_of(scene, run), "");
  const Scene recorded = parse_scene(text.str(), "recorded.toml");
  REQUIRE(recorded.stitches.size() == 1);
  CHECK(recorded.stitches[0].ends[0].node == 3u);
  CHECK(!recorded.stitches[0].ends[1].node);
  Simulation again(recorded, placed(recorded));
  frames(again, run.state().frame);
  CHECK(bytes(again) == bytes(run));
}

TEST_CASE("stitches that no body can have are refused", "[stitches]") {
  const Scene scene = two_blocks();
  Simulation run(scene, placed(scene));
  Stitch stitch = thread(0, 1);
  stitch.ends[1].node = 100000;
  CHECK_THROWS_AS(run.add_stitch(stitch), InputError);
  CHECK_THROWS_AS(run.stitch(0), std::out_of_range);
  CHECK_THROWS_AS(two_blocks("[[stitch]]\npoint_a = [0, 0, 0]\n"), InputError);
  CHECK_THROWS_AS(two_blocks("[[stitch]]\npoint_a = [0, 0, 0]\npoint_b = [1, 0, 0]\nlength = -1\n"), InputError);
}
