// Prestretch: bodies that are stretched at rest, beside the law of the material; bodies that keep
// their shape under load; and slits that open.
#include "simulation/prestretch.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <sstream>

#include "cases.h"
#include "kerf/body_file.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/simulation.h"
#include "simulation/single_body.h"

using namespace geo;

namespace {

constexpr double e = 1e-6, far = 9;

// A scene in which each frame ends in equilibrium: a frame is long beside the waves in the body.
Scene still_scene(double spacing) {
  Scene s = single_body_scene(spacing);
  s.frame_rate = 0.1;
  s.dt = 10;
  s.accuracy = 1e-6;
  s.self_contact = false;
  return s;
}

// A bar [0, 1] × [0, 0.3] × [0, 0.3] between jaws that hold x at both ends; y = 0 and z = 0 are
// planes of symmetry.
Scene held_bar() {
  Scene s = still_scene(0.08);
  s.supports = {{.lo = {-e, -far, -far}, .hi = {e, far, far}, .axes = {.x = true}},
                {.lo = {1 - e, -far, -far}, .hi = {1 + e, far, far}, .axes = {.x = true}},
                {.lo = {-far, -e, -far}, .hi = {far, e, far}, .axes = {.y = true}},
                {.lo = {-far, -far, -e}, .hi = {far, far, e}, .axes = {.z = true}}};
  return s;
}

// The nominal stress along x of a bar that is stretched by λ and free across.
double uniaxial_stress(const Material& material, double stretch) {
  double low = 0.5, high = 1.5;  // the stretch across, by bisection
  for (int k = 0; k < 60; ++k) {
    const double across = 0.5 * (low + high);
    const Mat3 f = Vec3(stretch, across, across).asDiagonal();
    (stress(material, f)(1, 1) > 0 ? high : low) = across;
  }
  return stress(material, Vec3(stretch, low, low).asDiagonal())(0, 0);
}

double largest_displacement(const Simulation& run) {
  double largest = 0;
  for (const Vec3& u : run.state().motion.displacement) largest = std::max(largest, u.norm());
  return largest;
}

}  // namespace

TEST_CASE("a bar that is stretched at rest pulls its jaws as the law of its material says", "[prestretch]") {
  for (const auto model : {ElasticModel::neo_hookean, ElasticModel::saint_venant_kirchhoff})
    for (const double stretch : {1.001, 1.2, 0.9}) {
      Scene s = held_bar();
      s.material.model = model;
      s.prestretch.stretch = {stretch, 1, 1};
      Simulation run(s, make_block({1, 0.3, 0.3}, 0.08));
      for (int f = 0; f < 8; ++f) run.advance_frame();
      const double force = run.advance_frame().support_force[0].x();
      const double expected = 0.09 * uniaxial_stress(s.material, stretch);
      INFO("stretch " << stretch << ", model " << int(model));
      CHECK(force == Approx(expected).epsilon(0.02));
    }
}

TEST_CASE("a free body gives its prestretch up and has no energy left", "[prestretch]") {
  Scene s = still_scene(0.12);
  s.prestretch.stretch = {1.2, 0.9, 1.1};
  Simulation run(s, make_block({1, 0.5, 0.5}, 0.12));
  FrameStats last;
  for (int f = 0; f < 12; ++f) last = run.advance_frame();
  Box3 box;
  for (const Vec3& p : run.surface().vertices) box.add(p);
  const Vec3 size = box.hi - box.lo;
  CHECK(size.x() == Approx(1 / 1.2).epsilon(2e-3));
  CHECK(size.y() == Approx(0.5 / 0.9).epsilon(2e-3));
  CHECK(size.z() == Approx(0.5 / 1.1).epsilon(2e-3));
  CHECK(last.energy < 1e-6 * s.material.young * 0.25);
}

TEST_CASE("energy and forces of a state see prestretch", "[prestretch]") {
  const std::uint64_t seed = seeds(1).first;
  INFO("seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const Simulation run(still_scene(0.2), make_block({1, 0.6, 0.4}, 0.2));
  State state = run.state().motion;
  const std::size_t points = run.solid().point_count();
  for (std::size_t i = 0; i < points; ++i) {
    Mat3 a;
    for (double& x : a.reshaped()) x = 0.1 * unit(random);
    state.prestretch.push_back(Mat3::Identity() + 0.5 * (a + a.transpose()));
  }
  std::vector<Vec3> direction;
  for (auto& u : state.displacement) {
    u = 0.01 * Vec3(unit(random), unit(random), unit(random));
    direction.push_back({unit(random), unit(random), unit(random)});
  }
  const std::vector<Vec3> force = run.solid().forces(state);
  double along = 0, largest = 0;
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < force.size(); ++i) {
    largest += force[i].norm();
    along += force[i].dot(direction[i]);
    sum += force[i];
  }
  const double h = 1e-5;
  State ahead = state, behind = state;
  for (std::size_t i = 0; i < force.size(); ++i) {
    ahead.displacement[i] += h * direction[i];
    behind.displacement[i] -= h * direction[i];
  }
  const double slope = (run.solid().energy(ahead) - run.solid().energy(behind)) / (2 * h);
  CHECK(-along == Approx(slope).epsilon(1e-5));
  CHECK(sum.norm() < 1e-9 * largest);
  CHECK(run.solid().energy(state) != Approx(run.solid().energy(state.displacement)).epsilon(1e-3));
  state.prestretch.pop_back();
  CHECK_THROWS_AS(run.solid().energy(state), InputError);
}

TEST_CASE("prestretch stays with the material over cuts", "[prestretch]") {
  const std::uint64_t seed = seeds(1).first;
  INFO("seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int k = 0; k < 6; ++k) {
    Scene s = still_scene(0.15);
    s.frame_rate = 24;
    s.dt = 1.0 / 24;
    s.prestretch.stretch = {1.1, 0.95, 1.05};
    s.material.discretisation = k % 3 == 2 ? Discretisation::mueller04 : Discretisation::galerkin;
    const double x = 0.3 * unit(random), tilt = 0.3 * unit(random);
    s.blades = {{.name = "blade", .points = {{x, -1, -1}, {x + tilt, -1, 1}}}};
    s.blades[0].motion.keys = {{.time = 0, .position = {0, 0, 0}}, {.time = 0.5, .position = {0, 2, 0}}};
    TriangleMesh block = make_block({1, 0.6, 0.4}, 0.15);
    for (Vec3& p : block.vertices) p -= Vec3(0.5, 0.3, 0.2);
    Simulation run(s, block);
    for (int f = 0; f < 12; ++f) run.advance_frame();
    const auto& prestretch = run.state().motion.prestretch;
    REQUIRE(prestretch.size() == run.solid().point_count());
    double largest = 0;
    for (const Mat3& v : prestretch) largest = std::max(largest, (v - Mat3(s.prestretch.stretch.asDiagonal())).norm());
    INFO("case " << k);
    CHECK(largest < 1e-12);
    CHECK(run.body().nodes.size() > 0);
  }
}

TEST_CASE("only the layer below the skin is stretched, in its plane", "[prestretch]") {
  Scene s = still_scene(0.1);
  s.prestretch = {.stretch = Vec3::Ones(), .skin = 1.2, .depth = 0.1};
  const Simulation run(s, make_block({1, 1, 1}, 0.2));
  const std::vector<Vec3> x = run.solid().point_positions();
  const std::vector<Mat3>& v = run.state().motion.prestretch;
  REQUIRE(v.size() == x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double depth = std::min(x[i].minCoeff(), (Vec3::Ones() - x[i]).minCoeff());
    if (depth > 0.1 + 1e-9) CHECK(v[i] == Mat3(Mat3::Identity()));
    if (depth < 0.1 - 1e-9) CHECK(v[i].determinant() == Approx(1.44));
    const bool below_floor = depth == x[i].z() && x[i].head<2>().minCoeff() > 0.2 && x[i].head<2>().maxCoeff() < 0.8;
    if (below_floor && depth < 0.09) CHECK((v[i] - Mat3(Vec3(1.2, 1.2, 1).asDiagonal())).norm() < 1e-12);
  }
}

TEST_CASE("loaded bodies keep their shape and are at rest from the start", "[prestretch]") {
  const std::uint64_t seed = seeds(1).first;
  INFO("seed " << seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int k = 0; k < 4; ++k) {
    Scene s = still_scene(0.1);
    s.frame_rate = 24;
    s.dt = 1.0 / 96;
    s.accuracy = 1e-3;
    s.gravity = {0, 0, -9.81};
    s.material.young = 4e5 * (1 + unit(random));
    s.material.poisson = 0.2 + 0.25 * unit(random);
    s.prestretch.stretch = {0.9 + 0.3 * unit(random), 1, 1};
    if (k % 2 == 0)
      s.grips = {{.lo = {-far, -far, -far}, .hi = {0.1, far, far}}};
    else
      s.ground = true;
    const TriangleMesh block = make_block({1, 0.3, 0.3}, 0.1);
    Simulation sags(s, block);
    s.loaded = true;
    Simulation rests(s, block);
    const double at_start = largest_displacement(rests);
    double kinetic = 0;
    for (int f = 0; f < 12; ++f) {
      kinetic = std::max(kinetic, rests.advance_frame().kinetic);
      sags.advance_frame();
    }
    INFO("case " << k << ", sags " << largest_displacement(sags));
    CHECK(at_start < 0.01 + 1e-12);
    CHECK(largest_displacement(rests) < 0.011);
    CHECK(largest_displacement(sags) > 0.02);
    CHECK(kinetic < 1e-4);  // of 90 kg: less than 2 mm/s
  }
}

TEST_CASE("a loaded body that nothing holds is refused", "[prestretch]") {
  Scene s = still_scene(0.2);
  s.gravity = {0, 0, -9.81};
  s.loaded = true;
  CHECK_THROWS_AS(Simulation(s, make_block({1, 0.5, 0.5}, 0.2)), GeometryError);
}

TEST_CASE("prestretch is in scenes and checkpoints", "[prestretch]") {
  const std::string text = R"(
[[body]]
mesh = "a.ply"
[[body]]
mesh = "b.ply"
[body.prestretch]
stretch = 1.25
skin = 1.5
depth = 0.01
[prestretch]
stretch = [1.1, 1, 0.9]
loaded = true
)";
  const Scene s = parse_scene(text, "scene.toml");
  CHECK(s.loaded);
  CHECK(s.prestretch == Prestretch{.stretch = {1.1, 1, 0.9}, .skin = 1, .depth = 0});
  CHECK(!s.bodies[0].prestretch);
  CHECK(s.bodies[1].prestretch == Prestretch{.stretch = Vec3::Constant(1.25), .skin = 1.5, .depth = 0.01});
  std::stringstream written;
  write_scene(written, s, "");
  const Scene again = parse_scene(written.str(), "again.toml");
  CHECK(again.loaded);
  CHECK(again.prestretch == s.prestretch);
  CHECK(again.bodies[1].prestretch == s.bodies[1].prestretch);
  for (const char* wrong : {"[prestretch]\nskin = 1.2", "[prestretch]\nstretch = 11", "[prestretch]\nstretch = [1, 2]",
                            "[prestretch]\nstretch = [0, 1, 1]"}) {
    const std::string bad = std::string("[body]\nmesh = \"a.ply\"\n") + wrong + "\n";
    CHECK_THROWS_AS(parse_scene(bad, "scene.toml"), InputError);
  }

  Scene run_scene = still_scene(0.2);
  run_scene.frame_rate = 24;
  run_scene.dt = 1.0 / 24;
  run_scene.prestretch.stretch = {1.2, 1, 1};
  Simulation run(run_scene, make_block({1, 0.5, 0.5}, 0.2));
  run.advance_frame();
  std::stringstream file;
  write_checkpoint(file, run.body(), run.state(), 1);
  Checkpoint c = read_checkpoint(KerfFile(Input(file.str(), "checkpoint")));
  CHECK(c.state.motion.prestretch == run.state().motion.prestretch);
  Simulation other(run_scene, std::move(c.body), std::move(c.state));
  run.advance_frame();
  other.advance_frame();
  CHECK(other.state().motion.displacement == run.state().motion.displacement);
}
