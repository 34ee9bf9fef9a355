// Pieces that rest sleep, and wake for all that would move them.
#include <catch2/catch.hpp>

#include <random>
#include <string>

#include "kerf/contact.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/parallel.h"
#include "kerf/simulation.h"
#include "simulation/kept_run.h"

using namespace geo;

namespace {

// Blocks of a metre on the ground: `a` stands, others are as the scene says.
Simulation run_of(const std::string& bodies, const std::string& more, const std::vector<TriangleMesh>& meshes) {
  const Scene scene = parse_scene(bodies + R"(
[material]
young = 1e5
damping = 6
[time]
frame_rate = 20
step = 0.05
sleep = 0.3
[ground]
)" + more,
                                  "s.toml");
  return {scene, place_models(scene, meshes)};
}

Simulation one_block(const std::string& more = "") {
  return run_of("[body]\nmesh = 'a'\nspacing = 0.25\n", more, {make_block({1, 1, 1}, 0.25)});
}

// Frames until nothing is computed; at most `most`.
int frames_to_sleep(Simulation& run, int most = 100) {
  for (int frame = 1; frame <= most; ++frame)
    if (run.advance_frame().newton == 0) return frame;
  return most + 1;
}

std::vector<Vec3> displacement(const Simulation& run) { return run.state().motion.displacement; }

// Whether run wakes in one of its next frames.
bool wakes(Simulation& run, int frames = 3) {
  std::size_t newton = 0;
  for (int frame = 0; frame < frames; ++frame) newton += run.advance_frame().newton;
  return newton > 0;
}

double lowest(const Simulation& run) {
  double z = 1e300;
  for (const Vec3& p : run.surface().vertices) z = std::min(z, p.z());
  return z;
}

}  // namespace

TEST_CASE("a block that stands still is not computed, and its energy and forces stay") {
  Simulation run = one_block();
  REQUIRE(frames_to_sleep(run) <= 60);
  const auto there = displacement(run);
  const FrameStats before = run.advance_frame();
  double mass = 0;
  for (std::uint32_t i = 0; i < run.solid().size(); ++i) mass += run.solid().mass(NodeId(i));
  CHECK(before.obstacle_force.at(0).z() == Approx(-9.81 * mass).epsilon(0.05));
  CHECK(before.energy > 0);
  CHECK(before.kinetic == 0);
  for (int frame = 0; frame < 5; ++frame) {
    const FrameStats stats = run.advance_frame();
    CHECK(stats.newton == 0);
    CHECK(stats.energy == before.energy);
    CHECK(stats.obstacle_force == before.obstacle_force);
  }
  CHECK((displacement(run) == there));
  CHECK(run.state().time == Approx(run.state().frame / 20.0));
}

TEST_CASE("what sleeps wakes for a pull, a change of weight, a cut, an obstacle and a grip that move") {
  SECTION("a pull") {
    Simulation run = one_block();
    REQUIRE(frames_to_sleep(run) <= 60);
    const auto there = displacement(run);
    Pull pull;
    pull.point = {0.5, 0.5, 0.98};
    pull.stiffness = 1e4;
    auto hook = run.add_pull(pull, {0.5, 0.5, 1.5});
    hook.drive_to({0.5, 0.5, 1.6});
    CHECK(wakes(run, 1));
    CHECK((displacement(run) != there));
  }
  SECTION("weight") {
    Simulation run = one_block();
    REQUIRE(frames_to_sleep(run) <= 60);
    run.change({.gravity = Vec3(2, 0, -4)});
    CHECK(wakes(run));
  }
  SECTION("a blow") {
    Simulation run = one_block();
    REQUIRE(frames_to_sleep(run) <= 60);
    run.strike({.point = {0.5, 0.5, 1}, .cells = 4});
    CHECK(wakes(run));
    CHECK(lowest(run) > -0.1);
  }
  SECTION("a cut") {
    Simulation run = one_block();
    REQUIRE(frames_to_sleep(run) <= 60);
    Blade blade;
    blade.points = {{-0.5, -0.5, 0}, {-0.5, 1.5, 0}};
    auto knife = run.add_blade(blade, {Vec3(0, 0, 0.5), Eigen::Quaterniond::Identity()});
    std::size_t cut = 0, newton = 0;
    for (int frame = 1; frame <= 24; ++frame) {
      knife.drive_to({Vec3(0.1 * frame, 0, 0.5), Eigen::Quaterniond::Identity()});
      const FrameStats stats = run.advance_frame();
      cut += stats.split.crack.triangles_cut;
      newton += stats.newton;
    }
    CHECK(cut > 0);
    CHECK(newton > 0);
    CHECK(frames_to_sleep(run) <= 60);  // and both pieces fall asleep again
  }
  SECTION("an obstacle") {
    Simulation run = one_block(
        "[[obstacle]]\nnormal = [1, 0, 0]\nposition = [-0.5, 0, 0]\nkeys = [[0, 0, 0, 0, 0, 0, 1, 0], "
        "[5, 0, 0, 0, 0, 0, 1, 0], [6, 1, 0, 0, 0, 0, 1, 0]]\n");
    REQUIRE(frames_to_sleep(run) <= 60);
    while (run.state().time < 4.9) CHECK(run.advance_frame().newton == 0);
    double most = 0;
    while (run.state().time < 6.1) most = std::max(most, double(run.advance_frame().newton));
    CHECK(most > 0);
    CHECK(run.state().motion.displacement[0].x() > 0.3);
  }
  SECTION("a grip") {
    Simulation run = one_block(
        "[[grip]]\nbox = [-0.1, -0.1, 0.9, 1.1, 1.1, 1.1]\nkeys = [[0, 0, 0, 0, 0, 0, 1, 0], "
        "[5, 0, 0, 0, 0, 0, 1, 0], [6, 0, 0, 1, 0, 0, 1, 0]]\n");
    REQUIRE(frames_to_sleep(run) <= 60);
    while (run.state().time < 7) run.advance_frame();
    CHECK(lowest(run) > 0.2);  // lifted, and stretched
  }
}

TEST_CASE("what falls on a sleeping block moves it, and far away another sleeps on") {
  const std::string bodies =
      "[[body]]\nmesh = 'a'\nspacing = 0.25\n[[body]]\nmesh = 'b'\nspacing = 0.25\nposition = [0.2, 0.1, 5]\n"
      "[[body]]\nmesh = 'c'\nspacing = 0.25\nposition = [8, 0, 0]\n";
  Simulation run =
      run_of(bodies, "", {make_block({1, 1, 1}, 0.25), make_block({0.6, 0.6, 0.6}, 0.2), make_block({1, 1, 1}, 0.25)});
  const auto of = [&](std::uint32_t body) {
    std::vector<Vec3> own;
    for (std::size_t i = 0; i < displacement(run).size(); ++i)
      if (run.state().body_index[i] == body) own.push_back(displacement(run)[i]);
    return own;
  };
  while (run.state().time < 1.5) run.advance_frame();
  const auto below = of(0), beside = of(2);
  double deepest = 0;
  while (run.state().time < 5) {
    const FrameStats stats = run.advance_frame();
    for (std::size_t i = 0; i < below.size(); ++i) deepest = std::max(deepest, (of(0)[i] - below[i]).norm());
    CHECK(count_crossings(run.surface()) == 0);
    CHECK((of(2) == beside));
    CHECK(stats.kinetic >= 0);
  }
  CHECK(deepest > 0.02);
  CHECK(lowest(run) > -0.05);
  REQUIRE(frames_to_sleep(run, 200) <= 200);
}

TEST_CASE("what has lost its support falls, and what turns in the air does not stay there") {
  SECTION("support") {
    Simulation run = run_of("[[body]]\nmesh = 'a'\nspacing = 0.25\nposition = [0, 0, 3.01]\n",
                            "[[obstacle]]\nnormal = [0, 0, 1]\nposition = [0, 0, 3]\nkeys = [[0, 0, 0, 0, 0, 0, 1, 0], "
                            "[5, 0, 0, 0, 0, 0, 1, 0], [5.05, 0, 0, -8, 0, 0, 1, 0]]\n",
                            {make_block({1, 1, 1}, 0.25)});
    REQUIRE(frames_to_sleep(run) <= 60);
    while (run.state().time < 8) run.advance_frame();
    CHECK(lowest(run) < 0.2);
  }
  SECTION("a body that leaves") {
    Simulation run = run_of(
        "[[body]]\nmesh = 'a'\nspacing = 0.25\n[[body]]\nmesh = 'b'\nspacing = 0.25\nposition = "
        "[0, 0, 1.01]\n[[grip]]\nbox = [-1, -1, -1, 2, 2, 0.9]\nkeys = [[0, 0, 0, 0, 0, 0, 1, 0], "
        "[5, 0, 0, 0, 0, 0, 1, 0], [5.1, 4, 0, 0, 0, 0, 1, 0]]\n",
        "", {make_block({1, 1, 1}, 0.25), make_block({1, 1, 1}, 0.25)});
    REQUIRE(frames_to_sleep(run) <= 60);
    while (run.state().time < 8) run.advance_frame();
    double highest = 0;
    for (const Vec3& p : run.surface().vertices) highest = std::max(highest, p.z());
    CHECK(highest < 1.6);
  }
  SECTION("in the air") {
    Simulation run = run_of("[[body]]\nmesh = 'a'\nspacing = 25\nvelocity = [0, 0, 9.81]\nposition = [0, 0, 1]\n", "",
                            {make_block({100, 100, 100}, 25)});
    for (int frame = 0; frame < 60; ++frame) {
      run.advance_frame();
      if (lowest(run) > 0.1) CHECK(run.state().motion.velocity[0].norm() > 0);
    }
    CHECK(lowest(run) < 1);
  }
}

TEST_CASE("forces of what sleeps do not depend on steps of a frame, checkpoints and past changes") {
  const auto force = [](int resumed) {
    Simulation run = one_block("[[change]]\ntime = 0.2\nfriction = 0.4\n[[change]]\ntime = 0.3\nstep = 0.0125\n");
    REQUIRE(frames_to_sleep(run) <= 80);
    for (int k = 0; k < resumed; ++k) {
      run = read_back(run.scene(), bytes(run));
      CHECK(run.advance_frame().kinetic == 0);
    }
    run.advance_frame();
    return run.advance_frame().obstacle_force.at(0).z();
  };
  const double once = force(0);
  CHECK(once == Approx(-9810).epsilon(0.05));
  CHECK(force(2) == Approx(once).epsilon(1e-6));
}

TEST_CASE("a run whose pieces sleep goes on from a checkpoint as without, with any threads") {
  Simulation run = one_block();
  for (int frame = 0; frame < 6; ++frame) run.advance_frame();
  Simulation again = read_back(run.scene(), bytes(run));
  set_threads(1);
  for (int frame = 0; frame < 40; ++frame) again.advance_frame();
  set_threads(0);
  for (int frame = 0; frame < 40; ++frame) run.advance_frame();
  CHECK(run.advance_frame().newton == 0);
  CHECK((bytes(again) != bytes(run)));  // a frame behind
  again.advance_frame();
  CHECK((bytes(again) == bytes(run)));
  Simulation asleep = read_back(run.scene(), bytes(run));
  const FrameStats first = asleep.advance_frame(), next = run.advance_frame();
  CHECK(first.energy == Approx(next.energy).epsilon(1e-3));
  CHECK(first.obstacle_force.at(0).z() == Approx(next.obstacle_force.at(0).z()).epsilon(1e-6));
  CHECK((bytes(asleep) == bytes(run)));
}
