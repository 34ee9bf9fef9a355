// Resistance to cutting: force and work of a blade beside energy times area; friction of flanks.
#include "simulation/edge_resistance.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "cases.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/simulation.h"
#include "simulation/single_body.h"

using namespace geo;

namespace {

// A block of gel that stands on held material, and a straight edge that goes down through it.
Scene gel(double resistance, double spacing) {
  Scene s = single_body_scene(spacing);
  s.frames = 30;
  s.grips = {{.lo = {-1, -1, -1}, .hi = {1, 1, 0.009}}};
  Blade blade{.name = "knife", .points = {{0.05, -0.02, 0.05}, {0.05, 0.08, 0.05}}};
  blade.motion.keys = {{.time = 0}, {.time = 1, .position = {0, 0, -0.04}}};
  blade.resistance = resistance;
  s.blades = {blade};
  return s;
}

struct Totals {
  double work = 0, cut = 0, elastic = 0, kinetic = 0, largest_force = 0, steady_force = 0;
  std::size_t refused = 0;
};

Totals run_of(const Scene& s, const TriangleMesh& model) {
  Simulation run(s, model);
  Totals t;
  int steady = 0;
  for (int f = 1; f <= 24; ++f) {
    const FrameStats stats = run.advance_frame();
    t.work += stats.work;
    t.cut += stats.cut_energy;
    t.elastic = stats.energy;
    t.kinetic = stats.kinetic;
    t.refused += stats.refused;
    const double force = stats.blade_force[0].norm();
    t.largest_force = std::max(t.largest_force, force);
    if (f < 14 || f > 22) continue;
    t.steady_force += force;
    ++steady;
  }
  t.steady_force /= steady;
  return t;
}

}  // namespace

TEST_CASE("a blade takes the energy of the area that it cuts, and its force is that times its width", "[resistance]") {
  const TriangleMesh model = make_block({0.1, 0.06, 0.04}, 0.01);
  for (const double resistance : {5.0, 20.0}) {
    const Totals t = run_of(gel(resistance, 0.01), model);
    INFO("resistance " << resistance << ": work " << t.work << ", cut " << t.cut << ", elastic " << t.elastic);
    CHECK(t.steady_force == Approx(0.06 * resistance).epsilon(0.05));
    // The edge ends 0.03 below the top.
    CHECK(t.cut == Approx(0.03 * 0.06 * resistance).epsilon(0.05));
    CHECK(t.work == Approx(t.cut + t.elastic + t.kinetic).epsilon(0.05));
  }
}

TEST_CASE("a blade enters soft material, which it dents by more than a node spacing", "[resistance]") {
  // resistance / young is 2.5 mm, a third of the spacing.
  for (const double spacing : {0.008, 0.0085, 0.009}) {
    Scene s = gel(50, spacing);
    s.material.young = 2e4;
    const Totals t = run_of(s, make_block({0.1, 0.06, 0.04}, 0.01));
    INFO("spacing " << spacing << ": work " << t.work << ", cut " << t.cut << ", elastic " << t.elastic << ", refused "
                    << t.refused);
    CHECK(t.refused < 5);
    CHECK(t.cut > 0.75 * 0.03 * 0.06 * 50);
    CHECK(t.work == Approx(t.cut + t.elastic + t.kinetic).epsilon(0.1));
  }
}

TEST_CASE("a blade without a resistance cuts as before, without a force", "[resistance]") {
  const Totals t = run_of(gel(0, 0.01), make_block({0.1, 0.06, 0.04}, 0.01));
  CHECK(t.largest_force == 0);
  CHECK(t.cut == 0);
  CHECK(t.work == 0);
}

TEST_CASE("the material indents before it parts, the more the duller the blade", "[resistance]") {
  const TriangleMesh model = make_block({0.1, 0.06, 0.04}, 0.01);
  const auto indentation = [&](double resistance) {
    Scene s = gel(resistance, 0.01);
    Simulation run(s, model);
    for (int f = 0; f < 8; ++f) run.advance_frame();  // the edge is 3.3 mm below the top
    // Beside the cut: its own walls are lower.
    double lowest = 0;
    const TriangleMesh now = run.surface();
    for (const Vec3& p : now.vertices)
      if (const double x = std::abs(p.x() - 0.05); x > 0.006 && x < 0.012 && p.z() > 0.03)
        lowest = std::max(lowest, 0.04 - p.z());
    return lowest;
  };
  const double sharp = indentation(1), dull = indentation(50);
  INFO("sharp " << sharp << ", dull " << dull);
  CHECK(dull > 2 * sharp);
}

TEST_CASE("a blade that goes back in its cut is not held", "[resistance]") {
  Scene s = gel(20, 0.01);
  s.blades[0].motion.keys = {
      {.time = 0}, {.time = 0.6, .position = {0, 0, -0.03}}, {.time = 1, .position = {0, 0, 0.01}}};
  Simulation run(s, make_block({0.1, 0.06, 0.04}, 0.01));
  double work_in = 0, work_back = 0, cut_back = 0;
  for (int f = 1; f <= 24; ++f) {
    const FrameStats stats = run.advance_frame();
    (f <= 14 ? work_in : work_back) += stats.work;
    if (f > 15) cut_back += stats.cut_energy;
  }
  CHECK(work_in > 0.01);
  CHECK(std::abs(work_back) < 0.1 * work_in);  // what was stored in the body comes back
  CHECK(cut_back < 0.01 * work_in);
}

TEST_CASE("random blades with a resistance: force times way is spent, and none makes energy", "[resistance]") {
  const Seeds which = seeds(6);
  for (int k = 0; k < which.count; ++k) {
    const std::uint64_t seed = which.first + static_cast<std::uint64_t>(k);
    INFO("seed " << seed);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    Scene s = gel(10 * (1.2 + unit(random)), 0.011);
    const double tilt = 0.02 * unit(random), lean = 0.01 * unit(random);
    s.blades[0].points = {{0.05 - tilt, -0.02, 0.05 - lean}, {0.05 + tilt, 0.08, 0.05 + lean}};
    s.blades[0].motion.keys[1].position.x() = 0.015 * unit(random);
    const Totals t = run_of(s, make_block({0.1, 0.06, 0.04}, 0.01));
    CHECK(t.work >= t.cut * 0.97);
    CHECK(t.work <= 1.1 * (t.cut + t.elastic + t.kinetic));
  }
}

TEST_CASE("friction of the flanks of a wedge adds to its force", "[resistance]") {
  const TriangleMesh model = make_block({0.1, 0.06, 0.04}, 0.01);
  const auto with = [&](double friction) {
    Scene s = gel(0, 0.01);
    s.blades[0].back = {0, 0, 0.03};
    s.blades[0].thickness = 0.004;
    s.blades[0].friction = friction;
    return run_of(s, model);
  };
  const Totals without = with(0), rough = with(0.5);
  INFO("force without " << without.steady_force << ", with " << rough.steady_force);
  CHECK(without.steady_force > 0);
  CHECK(rough.steady_force > 1.1 * without.steady_force);
  CHECK(rough.work > without.work);
}

TEST_CASE("scenes have friction and resistance of blades", "[resistance]") {
  const std::string text = R"(
[body]
mesh = "a.ply"
[[blade]]
points = [[0, 0, 0], [1, 0, 0]]
keys = [[0, 0, 0, 0, 0, 0, 1, 0], [1, 0, 0, 1, 0, 0, 1, 0]]
)";
  const Scene s = parse_scene(text + "back = [0, 0, 1]\nthickness = 0.1\nfriction = 0.3\nresistance = 40\n", "s.toml");
  CHECK(s.blades[0].friction == 0.3);
  CHECK(s.blades[0].resistance == 40);
  CHECK_THROWS_AS(parse_scene(text + "friction = 0.3\n", "s.toml"), InputError);
  CHECK_THROWS_AS(parse_scene(text + "resistance = -1\n", "s.toml"), InputError);
  CHECK_THROWS_AS(parse_scene(text + "resistance = 1\n[time]\nintegrator = \"leapfrog\"\n", "s.toml"), InputError);
}
