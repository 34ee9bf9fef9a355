// The as-rigid-as-possible energy of nodes: rigid motions, derivatives, momenta, stars that span no
// space.
#include "mechanics/discretisation/as_rigid_energy.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.h"
#include "cases.h"
#include "kerf/body.h"
#include "kerf/mesh.h"

using namespace geo;

namespace {

// Three to ten nodes in a block, anywhere, or as thin as 1/1000 in one or two directions.
Body random_nodes(Random& random) {
  NodeSet nodes;
  const std::uint32_t count = 3 + random.below(8);
  const auto thickness = [&] { return random.below(2) == 0 ? 1.0 : std::pow(10, random.uniform(-3, 0)); };
  const Vec3 extent(1, thickness(), thickness());
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 x(random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4));
    nodes.position.push_back(Vec3(0.5, 0.5, 0.5) + extent.cwiseProduct(x));
    nodes.radius.push_back(2);
    nodes.spacing.push_back(0.5);
    nodes.volume.push_back(1.0 / count);
  }
  return build_body(Complex::from_skin(make_block({1, 1, 1}, 1)), std::move(nodes));
}

AsRigidEnergy energy_of(const Body& body, double stiffness) {
  std::vector<NodeId> all;
  for (std::uint32_t i = 0; i < body.nodes.size(); ++i) all.push_back(NodeId(i));
  NodalGradientOperator gradients;
  gradients.update(body.nodes, body.graph, all);
  return {gradients, std::vector<double>(body.nodes.size(), stiffness)};
}

// Energy, and forces where wanted.
double evaluate(const AsRigidEnergy& all, const std::vector<Vec3>& u, std::vector<Vec3>* force = nullptr,
                std::vector<Mat3>* rotations = nullptr) {
  double sum = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    Mat3 rotation;
    sum += all.energy(k, u, rotation);
    if (force) all.add_force(k, u, rotation, *force);
    if (rotations) rotations->push_back(rotation);
  }
  return sum;
}

std::vector<Vec3> random_field(std::size_t count, double size, Random& random) {
  std::vector<Vec3> field;
  for (std::size_t i = 0; i < count; ++i) field.push_back(size * random.direction());
  return field;
}

double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

std::vector<Vec3> added(std::vector<Vec3> u, double share, const std::vector<Vec3>& p) {
  for (std::size_t i = 0; i < u.size(); ++i) u[i] += share * p[i];
  return u;
}

// Random nodes, their energy, and a rigid motion of them.
struct MovedNodes {
  explicit MovedNodes(Random& random) : body(random_nodes(random)), energy(energy_of(body, 1)) {
    const Mat3 turn = Eigen::AngleAxisd(random.uniform(0, 3), random.direction()).toRotationMatrix();
    const Vec3 shift = random.direction();
    for (const Vec3& x : body.nodes.position) rigid.push_back(turn * x + shift - x);
  }
  Body body;
  AsRigidEnergy energy;
  std::vector<Vec3> rigid;
};

}  // namespace

TEST_CASE("the as-rigid-as-possible energy is that of strains alone, with forces that keep momenta", "[as_rigid]") {
  const Seeds all = seeds(2000);
  for (std::uint64_t seed = all.first; seed < all.first + static_cast<std::uint64_t>(all.count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const auto [body, energy, rigid] = MovedNodes(random);
    const std::size_t n = body.nodes.size();
    CHECK(evaluate(energy, rigid) < 1e-20 * n);

    const std::vector<Vec3> u = added(rigid, 1, random_field(n, 0.1, random));
    std::vector<Vec3> force(n, Vec3::Zero());
    const double here = evaluate(energy, u, &force);
    CHECK(here > 0);
    Vec3 sum = Vec3::Zero(), torque = sum;
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      sum += force[i];
      torque += (body.nodes.position[i] + u[i]).cross(force[i]);
      largest = std::max(largest, force[i].norm());
    }
    CHECK(sum.norm() < 1e-10 * largest);
    CHECK(torque.norm() < 1e-9 * largest);

    // Not less than the tangent plane of a bound from above: the energy at a fixed rotation.
    const std::vector<Vec3> p = random_field(n, 1e-6, random);
    std::vector<double> diagonal(n, 0);
    energy.add_diagonal(diagonal);
    double curvature = 0;
    for (std::size_t i = 0; i < n; ++i) curvature += 2 * diagonal[i] * p[i].squaredNorm();
    CHECK(evaluate(energy, added(u, 1, p)) <= here - dot(force, p) + 0.5 * curvature + 1e-12 * here);
  }
}

TEST_CASE("the Hessian of the as-rigid-as-possible energy is exact at rest, wherever the rest has turned",
          "[as_rigid]") {
  const Seeds all = seeds(2000);
  for (std::uint64_t seed = all.first; seed < all.first + static_cast<std::uint64_t>(all.count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const auto [body, energy, rigid] = MovedNodes(random);
    const std::size_t n = body.nodes.size();
    std::vector<Mat3> rotations;
    evaluate(energy, rigid, nullptr, &rotations);
    // As small as the nodes' least extent: the energy is of fourth order in what turns them about
    // it.
    double least = 1;
    for (int axis = 1; axis < 3; ++axis) {
      double extent = 0;
      for (const Vec3& x : body.nodes.position) extent = std::max(extent, std::abs(x[axis] - 0.5));
      least = std::min(least, extent);
    }
    const std::vector<Vec3> p = random_field(n, 1e-3 * least, random), q = random_field(n, 1e-3 * least, random);
    std::vector<Vec3> hp(n, Vec3::Zero()), hq = hp;
    for (std::size_t k = 0; k < energy.size(); ++k) {
      energy.add_product(k, rotations[k], p, hp);
      energy.add_product(k, rotations[k], q, hq);
    }
    CHECK(dot(p, hp) >= 0);
    CHECK(dot(p, hq) == Approx(dot(q, hp)).epsilon(1e-6).margin(1e-9 * dot(p, hp)));
    CHECK(evaluate(energy, added(rigid, 1, p)) == Approx(0.5 * dot(p, hp)).epsilon(0.1));
  }
}
