// Debris: nodes without strain move as rigid bodies.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "kerf/body.h"
#include "kerf/mesh.h"
#include "kerf/solid.h"
#include "mechanics/solver/solid_discretisation.h"

using namespace geo;

namespace {

// A block with two or three nodes: too few for a gradient.
Body random_debris(Random& random) {
  NodeSet nodes;
  const int n = random.uniform() < 0.5 ? 2 : 3;
  for (int i = 0; i < n; ++i) {
    nodes.position.push_back({random.uniform(0.1, 0.9), random.uniform(0.1, 0.9), random.uniform(0.1, 0.9)});
    nodes.radius.push_back(2);
    nodes.spacing.push_back(0.8);
    nodes.volume.push_back(1.0 / n);
  }
  return build_body(Complex::from_skin(make_block({1, 1, 1}, 1)), std::move(nodes));
}

// The largest difference of a distance between two nodes from that at rest.
double strain(const Body& d, const State& state) {
  double largest = 0;
  for (std::size_t i = 0; i < d.nodes.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 rest = d.nodes.position[i] - d.nodes.position[j];
      largest =
          std::max(largest, std::abs((rest + state.displacement[i] - state.displacement[j]).norm() / rest.norm() - 1));
    }
  return largest;
}

Material material() {
  Material m;
  m.young = 1e5;
  m.density = 1000;
  m.damping = 0;
  return m;
}

}  // namespace

TEST_CASE("debris moves as a rigid body, with its momenta, in implicit and explicit steps", "[debris]") {
  const Seeds all = seeds(1000);
  for (std::uint64_t seed = all.first; seed < all.first + std::uint64_t(all.count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Body d = random_debris(random);
    Solid solid(d, material());
    State state{std::vector<Vec3>(d.nodes.size(), Vec3::Zero()), {}};
    for (std::size_t i = 0; i < d.nodes.size(); ++i) state.velocity.push_back(random.direction());
    Environment environment;
    environment.gravity = Vec3::Zero();
    const Vec3 momentum = solid.momentum(state);
    for (int step = 0; step < 4; ++step) {
      if (seed % 2)
        solid.step_implicit(state, 0.01, environment);
      else
        solid.step_explicit(state, 0.01, environment);
      CHECK(strain(d, state) < 1e-9);
      CHECK((solid.momentum(state) - momentum).norm() < 1e-9 * (1 + momentum.norm()));
    }
    // From here on, its nodes move as one: a step keeps the angular momentum, too, to second order.
    const Vec3 angular = solid.angular_momentum(state);
    solid.step_implicit(state, 1e-4, environment);
    CHECK((solid.angular_momentum(state) - angular).norm() < 1e-4 * (1 + angular.norm()));
  }
}

TEST_CASE("debris turns with its nodes, and its gradient is that rotation", "[debris]") {
  Random random(7);
  for (int k = 0; k < 100; ++k) {
    INFO("case " << k);
    const Body d = random_debris(random);
    Solid solid(d, material());
    State state{std::vector<Vec3>(d.nodes.size(), Vec3::Zero()), {}};
    const Vec3 spin = 20 * random.direction();
    Vec3 centre = Vec3::Zero();
    double mass = 0;
    for (std::size_t i = 0; i < d.nodes.size(); ++i) {
      centre += solid.mass(NodeId(i)) * d.nodes.position[i];
      mass += solid.mass(NodeId(i));
    }
    centre /= mass;
    for (const Vec3& x : d.nodes.position) state.velocity.push_back(spin.cross(x - centre));
    Environment environment;
    environment.gravity = Vec3::Zero();
    for (int step = 0; step < 20; ++step) solid.step_implicit(state, 0.005, environment);
    REQUIRE(state.rotation.size() == d.nodes.size());
    const std::vector<Mat3> gradients = solid.gradients(state.displacement);
    for (std::size_t i = 0; i < d.nodes.size(); ++i) {
      CHECK((state.rotation[i].transpose() * state.rotation[i] - Mat3::Identity()).norm() < 1e-9);
      for (std::size_t j = 0; j < d.nodes.size(); ++j) {
        if (i == j) continue;
        const Vec3 rest = d.nodes.position[j] - d.nodes.position[i];
        const Vec3 now = rest + state.displacement[j] - state.displacement[i];
        CHECK((state.rotation[i] * rest - now).norm() < 1e-3 * rest.norm());
        CHECK(((Mat3::Identity() + gradients[i]) * rest - now).norm() < 1e-3 * rest.norm());
      }
    }
  }
}
