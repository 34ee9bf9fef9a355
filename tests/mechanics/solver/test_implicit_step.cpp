// Newton's method: what it may take for solved, and for whom.
#include <catch2/catch.hpp>

#include "base/random.h"
#include "contact/response/obstacle_penalty.h"
#include "contact/surface/surface_targets.h"
#include "kerf/potential.h"
#include "kerf/solid.h"
#include "mechanics/bodies.h"
#include "mechanics/material/elastic_lanes.h"

using namespace geo;

namespace {

Material rubber() {
  Material m;
  m.young = 1e4;
  m.density = 1000;
  m.damping = 0;
  return m;
}

// A block that was cut across at x = 0.5.
struct Halves {
  Body body;
  Solid solid;
  State state;
};
Halves two_halves() {
  Body body = block_body({1, 0.6, 0.6}, 0.12);
  Halves made{body, Solid(body, rubber()), at_rest(body)};
  auto front = begin_front(blade_at({0.5, -0.2, 0.9}, {0.5, 0.9, 0.9}, {0, 0, -0.4}, 0), false, 1);
  for (int k = 1; k <= 3; ++k)
    made.solid.update(made.body, split(made.body, front, blade_at({0.5, -0.2, 0.9}, {0.5, 0.9, 0.9}, {0, 0, -0.4}, k)),
                      made.state);
  return made;
}

}  // namespace

TEST_CASE("no step brings energy, however little accuracy is asked for") {
  const Body body = block_body({1, 0.5, 0.5}, 0.1);
  Solid solid(body, rubber());
  Environment env;
  env.gravity.setZero();
  for (const double accuracy : {1e-3, 0.03, 0.3, 3.0}) {
    State state = at_rest(body);
    Random random(4);
    for (std::size_t i = 0; i < body.nodes.size(); ++i) {
      const Vec3& x = body.nodes.position[i];
      state.velocity[i] = Vec3(0, 8 * (x.x() - 0.5), 0);
      if (x.x() < 0.3) state.displacement[i] = 0.04 * random.direction();
    }
    double before = solid.energy(state.displacement) + solid.kinetic_energy(state);
    for (int k = 0; k < 12; ++k) {
      solid.step_implicit(state, 0.03, env, accuracy);
      const double now = solid.energy(state.displacement) + solid.kinetic_energy(state);
      INFO("accuracy " << accuracy << ", step " << k << ": " << before << " -> " << now);
      CHECK(now < before * (1 + 1e-6));
      before = now;
    }
  }
}

TEST_CASE("what one part does is nothing to another") {
  auto [body, solid, state] = two_halves();
  Environment env;
  State torn = state;
  Random random(6);
  std::size_t left = 0;
  for (std::size_t i = 0; i < body.nodes.size(); ++i) {
    const Vec3& x = body.nodes.position[i];
    if (x.x() > 0.5)
      torn.displacement[i] = 0.08 * random.direction();
    else {
      state.velocity[i] = torn.velocity[i] = Vec3(0, 3 * x.x(), -x.z());
      ++left;
    }
  }
  REQUIRE((left > 10 && left + 10 < body.nodes.size()));
  solid.step_implicit(state, 0.03, env, 1e-4);
  solid.step_implicit(torn, 0.03, env, 1e-4);
  double most = 0, moved = 0;
  for (std::size_t i = 0; i < body.nodes.size(); ++i)
    if (body.nodes.position[i].x() < 0.5) {
      most = std::max(most, (torn.displacement[i] - state.displacement[i]).norm());
      moved = std::max(moved, state.displacement[i].norm());
    }
  CHECK(moved > 0.01);
  CHECK(most < 1e-4 * 0.12);
}

namespace {

// Holds nodes above where they were at y = 0.1, by springs of `k` N/m.
struct Bed : Potential {
  const std::vector<Vec3>& at;
  std::vector<NodeWeight> on;
  double firm;
  Bed(const std::vector<Vec3>& position, double k) : at(position), firm(k) {
    for (std::uint32_t i = 0; i < at.size(); ++i)
      if (at[i].y() < 0.1) on.push_back({i, 1});
  }
  std::size_t size() const override { return on.size(); }
  Stencil stencil(std::size_t k) const override { return {&on[k], 1}; }
  double energy(std::size_t, const Vec3& d) const override { return 0.5 * firm * std::pow(std::max(0.0, -d.y()), 2); }
  Derivatives derivatives(std::size_t, const Vec3& d) const override {
    if (d.y() < 0) return {-firm * d.y() * Vec3::UnitY(), firm * Vec3::UnitY() * Vec3::UnitY().transpose()};
    return {};
  }
};

}  // namespace

TEST_CASE("what presses on one part does so once, whatever another begins anew") {
  auto [body, solid, state] = two_halves();
  Bed bed(body.nodes.position, 2e3);
  REQUIRE(bed.on.size() > 10);
  Environment env;
  env.gravity = {0, -9.81, 0};
  env.contact = {&bed};
  // The right half stops dead: it is nowhere near where its acceleration would take it.
  state.acceleration.assign(body.nodes.size(), Vec3::Zero());
  State stopped = state;
  for (std::size_t i = 0; i < body.nodes.size(); ++i) {
    const bool right = body.nodes.position[i].x() > 0.5;
    state.velocity[i] = stopped.velocity[i] = right ? Vec3(Vec3::Zero()) : Vec3(0, -1, 0);
    if (right) stopped.acceleration[i] = 50 * Vec3(std::sin(9 * body.nodes.position[i].y()), 0, 0);
  }
  const StepReport one = solid.step_implicit(state, 0.03, env), other = solid.step_implicit(stopped, 0.03, env);
  CHECK(one.substeps == 1);
  CHECK(other.newton <= one.newton + 3);
  bool same = true;
  for (std::size_t i = 0; i < body.nodes.size(); ++i)
    if (body.nodes.position[i].x() < 0.5) same &= stopped.displacement[i] == state.displacement[i];
  CHECK(same);
}

TEST_CASE("points side by side have the energy and the stress of one point's formulas") {
  for (const auto model : {ElasticModel::saint_venant_kirchhoff, ElasticModel::neo_hookean}) {
    Material m = rubber();
    m.model = model;
    m.volume_term = 2e3;
    Random random(9);
    for (const double size : {1e-7, 1e-3, 0.3, 1.5, 20.0}) {
      constexpr std::size_t count = 24;
      PointMatrices<double> gradient;
      gradient.resize(count);
      std::vector<double> volume(count, 0), energy;
      std::vector<Mat3> f(count, Mat3::Identity());
      for (std::size_t i = 0; i < count; ++i) {
        if (i % 5 != 4) volume[i] = 0.1 + 0.01 * double(i);
        for (int c = 0; c < 3; ++c)
          for (int r = 0; r < 3; ++r) {
            const double g = size * random.uniform(-1, 1);
            gradient.column[c][4 * i + static_cast<std::size_t>(r)] = g;
            f[i](r, c) += g;
          }
      }
      PointMatrices<float> deformed;
      deformed.resize(count);
      energy.resize(count);
      elastic_response(elastic_constants(m), {0, count}, volume, {}, gradient, energy, &deformed);
      for (std::size_t i = 0; i < count; ++i) {
        CHECK(energy[i] ==
              Approx(volume[i] * energy_density(m, f[i])).epsilon(1e-8).margin(1e-14 * m.young * size * size));
        Mat3 p;
        for (int c = 0; c < 3; ++c) p.col(c) = Eigen::Map<const Vec3>(&gradient.column[c][4 * i]);
        CHECK((p - volume[i] * stress(m, f[i])).norm() < 1e-13 * m.young * (1 + std::pow(size, 5)));
        CHECK(deformed.column[1][4 * i + 2] == Approx(f[i](2, 1)).epsilon(1e-6).margin(1e-15));
      }
    }
  }
}

TEST_CASE("what a solid keeps from step to step changes nothing but time") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    Body body = block_body({1, 0.6, 0.6}, 0.13);
    Solid solid(body, rubber());
    State state = at_rest(body);
    const Vec3 a(random.uniform(0.3, 0.5), -0.2, 0.9), b(random.uniform(0.5, 0.7), 0.9, 0.9), down(0, 0, -0.16);
    auto front = begin_front(blade_at(a, b, down, 0), false, 1);
    Environment env;
    for (int k = 1; k <= 8; ++k) {
      if (random.below(2))
        solid.update(body, split(body, front, blade_at(a, b, down, static_cast<int>(front.step) + 1)), state);
      // Nodes that touch an obstacle have another stiffness upwards.
      SurfaceWeights weights;
      weights.rebuild(body, solid);
      const auto touch = [&](ObstaclePenalty& ground) {
        ground.find_contacts(weights, surface_targets(weights, state.displacement), 1, 1e-5);
      };
      const Eigen::Isometry3d place(Eigen::Translation3d(0, 0, 0.02));
      const auto below = std::make_shared<RigidShape>(RigidShape::half_space(Vec3::UnitZ()));
      ObstaclePenalty ground(below, {1e6, 0.5}, place, place), ground_anew = ground;
      const bool touches = random.below(2) == 1;
      if (touches) {
        touch(ground);
        touch(ground_anew);
      }
      env.fixed.assign(body.nodes.size(), 0);
      for (std::size_t i = 0; i < body.nodes.size(); ++i) env.fixed[i] = body.nodes.position[i].x() < 0.1 && k % 3 != 0;
      const double dt = random.below(3) ? 0.01 : 0.02;
      State anew = state;
      if (touches) env.contact = {&ground_anew};
      Solid(body, rubber()).step_implicit(anew, dt, env, 1e-3);
      if (touches) env.contact = {&ground};
      solid.step_implicit(state, dt, env, 1e-3);
      CHECK(anew.displacement == state.displacement);
      CHECK(anew.velocity == state.velocity);
      env.contact.clear();
    }
  }
}
