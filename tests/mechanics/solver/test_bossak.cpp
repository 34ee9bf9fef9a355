// Bossak's scheme: its formulas, its order, what turns and swings, and where it leaves the step to
// backward Euler.
#include "mechanics/solver/bossak.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.h"
#include "cases.h"
#include "kerf/solid.h"
#include "mechanics/bodies.h"

using namespace geo;

namespace {

constexpr double default_step = 1.0 / 96;

Material elastic(double young, double damping = 0) {
  Material m;
  m.young = young;
  m.poisson = 0.3;
  m.density = 1000;
  m.damping = damping;
  return m;
}

void step(Solid& solid, State& state, double dt, const Environment& environment, double accuracy = 1e-3,
          ImplicitScheme scheme = ImplicitScheme::bossak) {
  solid.step_implicit(state, dt, environment, accuracy, Division::allowed, scheme);
}

Environment without_gravity() {
  Environment environment;
  environment.gravity.setZero();
  return environment;
}

State spinning(const Body& body, double rate) {
  State state = at_rest(body);
  for (std::size_t i = 0; i < body.nodes.size(); ++i)
    state.velocity[i] = Vec3(0, 0, rate).cross(body.nodes.position[i] - Vec3(1, 0.2, 0.2));
  return state;
}

// Kinetic, elastic and potential energy, J.
double total_energy(const Solid& solid, const Body& body, const State& state, const Vec3& gravity) {
  double energy = solid.kinetic_energy(state) + solid.energy(state);
  for (std::uint32_t i = 0; i < body.nodes.size(); ++i)
    energy -= solid.mass(NodeId(i)) * gravity.dot(body.nodes.position[i] + state.displacement[i]);
  return energy;
}

}  // namespace

TEST_CASE("a step of Bossak's scheme satisfies its balance and Newmark's formulas", "[bossak]") {
  const auto [first_seed, count] = seeds(50);
  for (int k = 0; k < count; ++k) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(k);
    CAPTURE(seed);
    Random random(seed);
    const double h = random.uniform(0.001, 0.1), alpha = -0.5, beta = 0.25 * (1 - alpha) * (1 - alpha);
    const Bossak before{.dt = h,
                        .drag = 0,
                        .displacement = random.direction(),
                        .velocity = random.direction(),
                        .acceleration = random.direction()};
    const Vec3 force = 10 * random.direction();  // over the mass
    const Vec3 u = before.target() + Bossak::inertial_share * h * h * force;
    const Vec3 a = before.acceleration_after(u), v = before.velocity_after(a);
    CHECK(((1 - alpha) * a + alpha * before.acceleration - force).norm() < 1e-9);
    CHECK((before.displacement + h * before.velocity + h * h * ((0.5 - beta) * before.acceleration + beta * a) - u)
              .norm() < 1e-13);
    CHECK((before.velocity + h * a - v).norm() < 1e-13);  // γ = 1
  }
}

TEST_CASE("errors of Bossak's scheme shrink with the square of the step, those of backward Euler with the step",
          "[bossak]") {
  const Body body = block_body({2, 0.4, 0.4}, 0.2);
  const Environment environment = without_gravity();
  const double end = 0.5;  // s: about a third of a turn, of a bar so stiff that its vibrations are small beside errors
  const auto run = [&](int steps, ImplicitScheme scheme) {
    Solid solid(body, elastic(1e9, 0.5));
    State state = spinning(body, 4);
    for (int k = 0; k < steps; ++k) step(solid, state, end / steps, environment, 1e-6, scheme);
    return state;
  };
  const State exact = run(800, ImplicitScheme::bossak);
  const auto error = [&](const State& state) {
    double sum = 0;
    for (std::size_t i = 0; i < state.displacement.size(); ++i)
      sum += (state.displacement[i] - exact.displacement[i]).squaredNorm();
    return std::sqrt(sum / double(state.displacement.size()));
  };
  const auto order = [&](ImplicitScheme scheme) {
    return std::log2(error(run(25, scheme)) / error(run(100, scheme))) / 2;
  };
  const double second = order(ImplicitScheme::bossak), first = order(ImplicitScheme::backward_euler);
  INFO("orders " << second << " and " << first);
  CHECK(second > 1.8);
  CHECK(first < 1.2);
}

TEST_CASE("a bar that spins keeps its energy and its angular momentum for ten seconds", "[bossak]") {
  const Body body = block_body({2, 0.4, 0.4}, 0.2);
  const Environment environment = without_gravity();
  for (const double young : {1e7, 1e10}) {
    const auto left = [&](ImplicitScheme scheme) {
      Solid solid(body, elastic(young));
      State state = spinning(body, 2);
      const auto momentum = [&] { return solid.angular_momentum(state).z(); };  // its middle is at rest
      const double energy = solid.kinetic_energy(state), turning = momentum();
      for (int k = 0; k < 960; ++k) step(solid, state, default_step, environment, 1e-3, scheme);
      return std::pair(solid.kinetic_energy(state) / energy, momentum() / turning);
    };
    const auto [energy, turning] = left(ImplicitScheme::bossak);
    const auto [damped, slowed] = left(ImplicitScheme::backward_euler);
    INFO("Young's modulus " << young << ": " << energy << ", " << turning << "; backward Euler " << damped << ", "
                            << slowed);
    CHECK(std::abs(energy - 1) < 0.01);
    CHECK(std::abs(turning - 1) < 0.01);
    CHECK((damped < 0.7 && slowed < 0.85));
  }
}

TEST_CASE("a bar that swings about a hinge keeps its energy for ten seconds", "[bossak]") {
  const Body body = block_body({2, 0.4, 0.4}, 0.2);
  const Vec3 gravity(0, 0, -9.81);
  Environment environment;
  environment.gravity = gravity;
  environment.fixed.assign(body.nodes.size(), 0);
  for (const double y : {0.1, 0.3}) {  // a hinge: two nodes near an edge at the foot
    const auto distance = [&](std::size_t i) { return (body.nodes.position[i] - Vec3(0.1, y, 0.1)).norm(); };
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < body.nodes.size(); ++i)
      if (distance(i) < distance(nearest)) nearest = i;
    environment.fixed[nearest] = 1;
  }
  REQUIRE(std::count(environment.fixed.begin(), environment.fixed.end(), 1) == 2);
  for (const double young : {1e7, 1e9}) {
    const auto run = [&](ImplicitScheme scheme) {
      Solid solid(body, elastic(young));
      State state = at_rest(body);
      const double begin = total_energy(solid, body, state, gravity);
      double highest = begin, lowest = begin;
      double fall = 0;  // of the bar, J: to where it hangs
      for (std::uint32_t i = 0; i < body.nodes.size(); ++i) fall += solid.mass(NodeId(i)) * gravity.norm();
      for (int k = 0; k < 960; ++k) {
        step(solid, state, default_step, environment, 1e-3, scheme);
        highest = std::max(highest, total_energy(solid, body, state, gravity));
        lowest = std::min(lowest, total_energy(solid, body, state, gravity));
      }
      return std::pair((highest - begin) / fall, (lowest - begin) / fall);
    };
    const auto [rise, loss] = run(ImplicitScheme::bossak);
    const auto [none, damped] = run(ImplicitScheme::backward_euler);
    CHECK(rise < 0.01);
    CHECK(loss > -0.01);
    CHECK(damped < -0.3);
  }
}
