// Loads and supports on the skin: a bar as in a testing machine, beside beam theory and balances.
#include "simulation/skin_loads.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/simulation.h"

using namespace geo;

namespace {

constexpr double young = 1e7, poisson = 0.3, e = 1e-6, far = 9;

// A bar [0, 2] × [0, 0.5] × [0, 0.5] whose planes x = 0, y = 0 and z = 0 are planes of symmetry.
Scene bar() {
  Scene s;
  s.bodies.resize(1);
  s.bodies[0].sampling.spacing = 0.1;
  s.bodies[0].sampling.levels = 1;
  s.material = {.young = young, .poisson = poisson, .density = 1000, .damping = 0};
  s.gravity = Vec3::Zero();
  s.frame_rate = 1e-2;  // a wave takes 0.02 s through the bar: each frame ends in equilibrium
  s.dt = 1e2;
  s.accuracy = 1e-6;
  s.self_contact = false;
  s.supports = {{.lo = {-e, -far, -far}, .hi = {e, far, far}, .axes = {.x = true}},
                {.lo = {-far, -e, -far}, .hi = {far, e, far}, .axes = {.y = true}},
                {.lo = {-far, -far, -e}, .hi = {far, far, e}, .axes = {.z = true}}};
  return s;
}

TriangleMesh model() { return make_block({2, 0.5, 0.5}, 0.1); }

// Mean motion along an axis of the vertices that lie at `at` of it, at rest, and in the bar's
// middle third.
double mean_motion(const Simulation& run, int axis, double at) {
  double sum = 0, count = 0;
  for (const Vec3& p : run.surface().vertices) {
    if (std::abs(p[axis] - at) > 0.04 || (axis != 0 && std::abs(p.x() - 1) > 0.35)) continue;
    sum += p[axis] - at;
    ++count;
  }
  return sum / count;
}

// A specimen of PMMA that is loaded slowly, in plane strain: both faces across z are held along it.
Scene slow_test(double spacing, double thickness, double toughness) {
  Scene s;
  s.bodies.resize(1);
  s.bodies[0].sampling.spacing = spacing;
  s.bodies[0].sampling.levels = 1;
  s.gravity = Vec3::Zero();
  s.material = {.young = 3e9, .poisson = 0.3, .density = 1200, .damping = 2000};
  s.frame_rate = 1000;
  s.dt = 2.5e-4;
  s.accuracy = 1e-7;
  s.self_contact = false;
  s.fracture.on = true;
  s.fracture.strength = 1e12;
  s.fracture.toughness = toughness;
  s.fracture.variation = 0;
  s.fracture.max_cracks = 0;
  for (const double z : {0.0, thickness})
    s.supports.push_back({.lo = {-far, -far, z - e}, .hi = {far, far, z + e}, .axes = {.z = true}});
  return s;
}

}  // namespace

TEST_CASE("a bar on planes of symmetry is stretched by a traction as Hooke's law says") {
  const double strain = 1e-3, area = 0.25;
  Scene scene = bar();
  scene.loads = {{.lo = {2 - e, -far, -far}, .hi = {2 + e, far, far}, .traction = {strain * young, 0, 0}}};
  Simulation run(scene, model());
  FrameStats last;
  double work = 0;
  for (int i = 0; i < 3; ++i) {
    last = run.advance_frame();
    work += last.work;
  }
  // The law of the material is not linear: within a few strains.
  CHECK(mean_motion(run, 0, 2) == Approx(2 * strain).epsilon(0.02));
  CHECK(-mean_motion(run, 1, 0.5) == Approx(0.5 * poisson * strain).epsilon(0.05));
  REQUIRE(last.support_force.size() == 3);
  CHECK(last.support_force[0].x() == Approx(strain * young * area).epsilon(0.005));
  CHECK(std::abs(last.support_force[1].y()) < 0.01 * strain * young * area);
  CHECK(last.support_force[0].y() == 0);  // free along the other axes
  // A load that acts suddenly does twice the work that is stored; backward Euler takes the rest.
  CHECK(work == Approx(2 * last.energy).epsilon(0.02));
}

TEST_CASE("a support that moves stretches the bar, and its force is the traction that would") {
  const double strain = 1e-3, area = 0.25;
  Scene scene = bar();
  Support jaw{.lo = {2 - e, -far, -far}, .hi = {2 + e, far, far}, .axes = {.x = true}};
  jaw.motion.keys = {{.time = 0, .position = Vec3::Zero()}, {.time = 100, .position = {2 * strain, 0, 0}}};
  scene.supports.push_back(jaw);
  Simulation run(scene, model());
  run.advance_frame();
  const FrameStats last = run.advance_frame();
  CHECK(mean_motion(run, 0, 2) == Approx(2 * strain).epsilon(0.01));
  CHECK(last.support_force.at(3).x() == Approx(-strain * young * area).epsilon(0.02));
}

TEST_CASE("loads begin, grow and end when they say") {
  const Load load{.lo = {}, .hi = {}, .traction = {1, 0, 0}, .from = 1, .ramp = 2, .until = 5};
  CHECK(load.share(1) == 0);
  CHECK(load.share(2) == 0.5);
  CHECK(load.share(4) == 1);
  CHECK(load.share(5.1) == 0);
  Scene scene = bar();
  scene.loads = {{.lo = {2 - e, -far, -far}, .hi = {2 + e, far, far}, .traction = {1e4, 0, 0}, .until = 150}};
  Simulation run(scene, model());
  run.advance_frame();
  CHECK(mean_motion(run, 0, 2) > 1e-3);
  run.advance_frame();
  run.advance_frame();
  CHECK(mean_motion(run, 0, 2) == Approx(0).margin(1e-6));
}

TEST_CASE("a box without skin is refused by number, and a larger box or finer triangles are the remedy") {
  Scene scene = bar();
  scene.loads = {{.lo = {2 - e, -far, -far}, .hi = {2 + e, 0.15, far}, .traction = {1e4, 0, 0}}};
  const auto made = [&](double edge) { Simulation(scene, make_block({2, 0.5, 0.5}, edge)); };
  CHECK_THROWS_WITH(made(0.5),
                    "load 1: its box holds no whole triangle of the skin; make the box larger, or the "
                    "model's triangles smaller");
  CHECK_NOTHROW(made(0.1));
  scene.loads[0].hi.y() = far;
  CHECK_NOTHROW(made(0.5));
  scene.supports[1].hi.y() = -2 * e;
  scene.supports[1].lo.y() = -1;
  CHECK_THROWS_WITH(made(0.1), Catch::Contains("support 2: its box"));
}

TEST_CASE("scenes keep their loads and supports when they are written and read") {
  const std::string text =
      "[body]\nmesh = 'a'\n[[load]]\nbox = [0, 0, 0, 1, 1, 1]\ntraction = [1, 2, 3]\nfrom = 0.5\nramp = 2\nuntil = 7\n"
      "[[support]]\nbox = [0, 0, 0, 1, 1, 2]\naxes = 'xz'\nfrom = 1\nkeys = [[0, 0, 0, 0, 0, 0, 1, 0], [1, 1, 0, 0, 0, "
      "0, 1, 0]]\n";
  std::ostringstream written;
  write_scene(written, parse_scene(text, "s.toml"), "");
  const Scene scene = parse_scene(written.str(), "t.toml");
  REQUIRE(scene.loads.size() == 1);
  CHECK(scene.loads[0].traction == Vec3(1, 2, 3));
  CHECK(scene.loads[0].from == 0.5);
  CHECK(scene.loads[0].ramp == 2);
  CHECK(scene.loads[0].until == 7);
  REQUIRE(scene.supports.size() == 1);
  CHECK(scene.supports[0].hi == Vec3(1, 1, 2));
  CHECK((scene.supports[0].axes.x && !scene.supports[0].axes.y && scene.supports[0].axes.z));
  CHECK(scene.supports[0].motion.keys.size() == 2);
  CHECK_FALSE(scene.supports[0].active(1));
  CHECK(scene.supports[0].active(1.5));
  const auto fails = [](const std::string& row, const std::string& why) {
    CHECK_THROWS_WITH(parse_scene("[body]\nmesh = 'a'\n" + row, "s.toml"), Catch::Contains(why));
  };
  fails("[[load]]\nbox = [0, 0, 0, 1, 1, 1]\n", "traction");
  fails("[[support]]\nbox = [0, 0, 0, 1, 1, 1]\naxes = 'xw'\n", "letters x, y and z");
  fails("[[support]]\nbox = [0, 0, 0, 1, 1, 1]\n", "axes");
  fails("[[support]]\nbox = [0, 0, 0, 1, 1, 1]\naxes = 'x'\nkeys = [[0, 0, 0, 0, 0, 0, 1, 5]]\n", "does not turn");
}

TEST_CASE("a prescored front goes on where the load passes its toughness, and not below", "[fracture]") {
  // A plate in tension with an edge crack of 0.3: K = σ √(π a) F (Tada, Paris and Irwin 2000).
  const double depth = 0.3, spacing = 1.0 / 16, thickness = 4 * spacing, stress = 1e4;
  const double k = stress * std::sqrt(M_PI * depth) * 1.66;
  const auto grows = [&](double toughness, int points) {
    Scene s = bar();
    s.bodies[0].sampling.spacing = spacing;
    s.fracture.on = true;
    s.fracture.strength = 1e15;
    s.fracture.toughness = toughness;
    s.fracture.variation = 0;
    s.fracture.max_cracks = 0;
    Front notch;
    for (const double y : {-0.1, depth}) {
      std::vector<Vec3>& row = notch.steps.emplace_back();
      for (int i = 0; i < points; ++i) row.push_back({1.501, y, thickness * (1.04 - 1.08 * i / (points - 1))});
    }
    s.scores = {{.front = notch}};
    s.supports = {{.lo = {-far, -far, -e}, .hi = {far, far, e}, .axes = {.z = true}},
                  {.lo = {-far, -far, thickness - e}, .hi = {far, far, thickness + e}, .axes = {.z = true}},
                  {.lo = {1.44, 1 - e, -far}, .hi = {1.56, 1 + e, far}, .axes = {.x = true, .y = true}}};
    s.loads = {{.lo = {3 - e, -far, -far}, .hi = {3 + e, far, far}, .traction = {stress, 0, 0}},
               {.lo = {-e, -far, -far}, .hi = {e, far, far}, .traction = {-stress, 0, 0}}};
    Simulation run(s, make_block({3, 1, thickness}, 0.05));
    FrameStats total;
    for (int i = 0; i < 4; ++i) total += run.advance_frame();
    REQUIRE(total.fracture.tips.size() <= 1);
    return total.fracture.advanced > 0;
  };
  CHECK(grows(0.9 * k, 9));
  CHECK_FALSE(grows(1.1 * k, 9));
  CHECK(grows(0.9 * k, 2));  // a front whose points are all outside the material
}

TEST_CASE("a notched beam in three-point bending breaks at the handbook's load, with the energy that it is given",
          "[fracture]") {
  // K = P S / (B W^1.5) f(a / W), with f(0.5) = 2.66 (Tada, Paris and Irwin 2000). The notch lies
  // on lines of the skin.
  const double height = 0.04, span = 0.16, thickness = 0.004, toughness = 1e6;
  const double load = toughness * thickness * std::pow(height, 1.5) / (span * 2.66);
  Scene s = slow_test(height / 16, thickness, toughness);
  Front notch;
  for (const double y : {-0.002, height / 2})
    notch.steps.push_back({{0.09, y, -2e-4}, {0.09, y, thickness / 2}, {0.09, y, thickness + 2e-4}});
  s.scores = {{.front = notch}};
  for (const double x : {0.01, 0.17})
    s.supports.push_back({.lo = {x - 1.01e-3, -e, -far}, .hi = {x + 1.01e-3, e, far}, .axes = {.y = true}});
  s.supports.push_back({.lo = {0.09 - 1.01e-3, height - e, -far},
                        .hi = {0.09 + 1.01e-3, height + e, far},
                        .axes = {.x = true, .y = true}});
  s.supports.back().motion.keys = {{.time = 0, .position = Vec3::Zero()}, {.time = 0.04, .position = {0, -8e-4, 0}}};
  Simulation run(s, make_block({0.18, height, thickness}, 0.001));
  double work = 0, force = 0;
  for (int frame = 0; frame < 24; ++frame) {
    const FrameStats stats = run.advance_frame();
    work += stats.work;
    INFO("frame " << frame << ": " << stats.energy << " + " << stats.kinetic << " J of " << work);
    CHECK(stats.energy + stats.kinetic < 1.005 * work);
    if (stats.fracture.advanced > 0) break;
    force = stats.support_force.at(4).y();
  }
  INFO("force over the handbook's: " << force / load);
  CHECK(std::abs(force / load - 1) < 0.05);
}

TEST_CASE("a split strip is pulled apart at the load of beam theory, wherever its crack is", "[fracture]") {
  // K = √12 P (a + 0.64 h) / (B h^1.5), with h the height of an arm (Kanninen 1973).
  const double arm = 0.01, thickness = 0.0025, toughness = 4e5;
  Scene s = slow_test(arm / 8, thickness, toughness);
  Front notch;
  for (const double x : {-0.001, 0.04}) notch.steps.push_back({{x, arm, -2e-4}, {x, arm, thickness + 2e-4}});
  s.scores = {{.front = notch}};
  for (const double way : {-1.0, 1.0}) {
    s.supports.push_back({.lo = {-e, way > 0 ? 1.501 * arm : -far, -far},
                          .hi = {e, way > 0 ? far : 0.501 * arm, far},
                          .axes = {.y = true}});
    s.supports.back().motion.keys = {{.time = 0, .position = Vec3::Zero()},
                                     {.time = 0.04, .position = {0, way * 4e-4, 0}}};
  }
  s.supports.push_back({.lo = {0.1 - e, -far, -far}, .hi = {far, far, far}, .axes = {.x = true}});
  Simulation run(s, make_block({0.1, 2 * arm, thickness}, 0.00125));
  double length = 0.04;
  for (int frame = 0; frame < 40; ++frame) {
    const FrameStats stats = run.advance_frame();
    REQUIRE(stats.fracture.tips.size() == 1);
    length = stats.fracture.tips[0].at.x();
    const double load = toughness * thickness * std::pow(arm, 1.5) / (std::sqrt(12.0) * (length + 0.64 * arm));
    INFO("frame " << frame << ": " << length << ", force over theory: " << stats.support_force.at(2).y() / load);
    CHECK(std::abs(stats.support_force.at(2).y()) < 1.08 * load);
    if (length > 0.041) CHECK(std::abs(stats.support_force.at(2).y()) > 0.88 * load);
  }
  CHECK(length > 0.045);
}
