// Stress intensities by the interaction integral, beside handbook solutions, and where there is
// none.
#include "simulation/interaction_integral.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "kerf/scene.h"
#include "kerf/simulation.h"
#include "simulation/fracture_tip.h"
#include "simulation/notched_block.h"

using namespace geo;

namespace {

enum class Loading { tension, bending };

// A plate in plane strain, 1 high, with a crack from y = 0 to `depth` in the plane x ≈ 0; its ends
// are pulled by `stress`, or bent by a moment of stress / 4 for a unit of thickness.
struct EdgeCrack {
  Loading loading;
  double depth, spacing, stress = 1e4;
  std::uint64_t seed = 1;

  // Tada, Paris and Irwin 2000, a plate with a crack from its edge: K = σ √(π a) F(a / W), with the
  // nominal stress 6 M / W² in bending.
  double intensity() const {
    const double a = depth, root = std::sqrt(std::numbers::pi * a);
    if (loading == Loading::tension)
      return stress * root * (1.12 - 0.231 * a + 10.55 * a * a - 21.72 * a * a * a + 30.39 * a * a * a * a);
    return 1.5 * stress * root * (1.122 - 1.40 * a + 7.33 * a * a - 13.08 * a * a * a + 14 * a * a * a * a);
  }

  Scene scene() const {
    const double length = 3, thickness = 4 * spacing, e = 1e-6, far = 9;
    Scene s;
    s.bodies.resize(1);
    s.bodies[0].sampling.spacing = spacing;
    s.bodies[0].sampling.levels = 1;
    s.bodies[0].sampling.seed = seed;
    s.material = {.young = 1e9, .poisson = 0.3, .density = 1000, .damping = 0};
    s.gravity = Vec3::Zero();
    s.frame_rate = 1e-3;  // the longest wave takes 3e-3 s: the frame ends in equilibrium
    s.dt = 1e3;
    s.accuracy = 1e-7;
    s.self_contact = false;
    s.fracture.on = true;
    s.fracture.toughness = s.fracture.strength = 1e15;
    s.fracture.max_cracks = 0;
    Front notch;
    for (const double y : {-0.1, depth}) {
      std::vector<Vec3>& row = notch.steps.emplace_back();
      for (int i = 0; i < 9; ++i) row.push_back({1e-3, y, thickness * (1.04 - 1.08 * i / 8)});
    }
    s.scores.push_back({.front = notch});
    for (const double z : {0.0, thickness})
      s.supports.push_back({.lo = {-far, -far, z - e}, .hi = {far, far, z + e}, .axes = {.z = true}});
    s.supports.push_back({.lo = {-0.06, 1 - e, -far}, .hi = {0.06, 1 + e, far}, .axes = {.x = true, .y = true}});
    for (const double side : {-1.0, 1.0})
      for (const bool upper : {false, true}) {
        const double sign = upper && loading == Loading::bending ? -side : side;
        s.loads.push_back({.lo = {side * length / 2 - e, upper ? 0.5 - e : -far, -far},
                           .hi = {side * length / 2 + e, upper ? far : 0.5 + e, far},
                           .traction = {sign * stress, 0, 0}});
      }
    return s;
  }

  TriangleMesh model() const {
    TriangleMesh mesh = make_block({3, 1, 4 * spacing}, 0.05);
    for (Vec3& p : mesh.vertices) p.x() -= 1.5;
    return mesh;
  }
};

}  // namespace

TEST_CASE("stress intensities of an edge crack in tension and in bending are those of the handbook", "[fracture]") {
  const Loading loading = GENERATE(Loading::tension, Loading::bending);
  const double depth = GENERATE(0.3, 0.5);
  const EdgeCrack crack{.loading = loading, .depth = depth, .spacing = 1.0 / 16};
  Simulation run(crack.scene(), crack.model());
  run.advance_frame();
  run.advance_frame();
  REQUIRE(run.state().fracture.fronts.size() == 1);
  const GrowingFront& front = run.state().fracture.fronts[0];
  const InteractionIntegral integral(run.body(), run.solid(), run.state().motion);
  Vec3 mean = Vec3::Zero();
  double points = 0;
  for (std::size_t i = 0; i < front.size(); ++i) {
    if (!front.live(i)) continue;
    const std::optional<Vec3> k = integral.at(front, i, Mat3::Identity());
    REQUIRE(k);
    INFO("at z = " << front.front.points[i].position.z() << ": " << k->transpose() / crack.intensity());
    CHECK(std::abs((*k)[0] / crack.intensity() - 1) < 0.08);
    CHECK(std::abs((*k)[1]) < 0.05 * crack.intensity());
    mean += *k;
    ++points;
  }
  REQUIRE(points >= 5);
  INFO("mean " << mean.transpose() / points / crack.intensity());
  CHECK(std::abs(mean[0] / points / crack.intensity() - 1) < 0.05);
}

TEST_CASE("no stress intensity comes from a domain that other surfaces cut short", "[fracture]") {
  const double spacing = 0.08;
  const auto at_middle = [&](double depth, double height) {
    const Notched n = notched_block({1, 1, 0.4}, spacing, depth, height);
    const Solid solid(n.body, Materials(Material{}));
    const State rest{.displacement = std::vector<Vec3>(n.body.nodes.size(), Vec3::Zero()), .velocity = {}};
    return InteractionIntegral(n.body, solid, rest).at(n.front, n.front.size() / 2, Mat3::Identity());
  };
  CHECK(at_middle(0.5, 0.507).has_value());
  CHECK_FALSE(at_middle(0.1, 0.507).has_value());                // a crack of one spacing
  CHECK_FALSE(at_middle(1 - 1.2 * spacing, 0.507).has_value());  // the skin is ahead
  CHECK_FALSE(at_middle(0.5, 1.2 * spacing).has_value());        // and beside it
}

TEST_CASE("slopes of the modes are the derivatives of their displacements", "[fracture]") {
  Random random(7);
  for (int i = 0; i < 1000; ++i) {
    const Material material{.young = 1e6, .poisson = random.uniform(-0.5, 0.45)};
    const double x = random.uniform(-1, 1), y = random.uniform(0.1, 1), step = 1e-6;
    const auto at = [&](double ahead) {
      return mode_displacement(material, std::hypot(ahead, y), std::atan2(y, ahead));
    };
    const Mat3 difference = (at(x + step) - at(x - step)) / (2 * step);
    const Mat3 slope = mode_slope(material, std::hypot(x, y), std::atan2(y, x));
    CHECK((slope - difference).norm() < 1e-7 * slope.norm() + 1e-15);
  }
}

TEST_CASE("stress intensities exist where the crack leaves slivers of the skin beside its front", "[fracture]") {
  // A diagonal of the strip meets the side of the block at x = 0.4, on lines of the skin.
  const std::uint64_t seed = GENERATE(range(1, 25));
  INFO("seed " << seed);
  Random random(seed);
  const double height = random.uniform(0.35, 0.65), spacing = 0.08;
  const auto line = [&](double x) {
    std::vector<Vec3> p;
    for (const double z : {0.42, 0.3, 0.2, 0.1, -0.02}) p.push_back({x, height, z});
    return p;
  };
  SampleOptions sampling;
  sampling.spacing = spacing;
  sampling.levels = 1;
  sampling.seed = seed;
  const TriangleMesh mesh = make_block({1, 1, 0.4}, 0.1);
  Body body = build_body(Complex::from_skin(mesh), sample_nodes(mesh, sampling));
  FrontState front = begin_front(line(-0.1), false, 1);
  split(body, front, line(0.5));
  const GrowingFront tip = growing(front, std::vector<Vec3>(front.points.size(), Vec3(0, 1, 0)));
  const Solid solid(body, Materials(Material{}));
  const State rest{.displacement = std::vector<Vec3>(body.nodes.size(), Vec3::Zero()), .velocity = {}};
  const InteractionIntegral integral(body, solid, rest);
  for (std::size_t i = 0; i < tip.size(); ++i)
    if (tip.live(i)) CHECK(integral.at(tip, i, Mat3::Identity()).has_value());
}
