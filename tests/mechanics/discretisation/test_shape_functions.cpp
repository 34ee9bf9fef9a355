// The kernel, Eq. 1 and gradients of shape functions at one point.
#include "mechanics/discretisation/shape_functions.h"

#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "cases.h"
#include "mechanics/discretisation/kernel.h"

using namespace geo;

namespace {

constexpr double support = 0.8;

std::vector<Vec3> random_nodes(Random& random, std::size_t count) {
  std::vector<Vec3> nodes;
  for (std::size_t j = 0; j < count; ++j) nodes.push_back(0.5 * random.uniform() * random.direction());
  return nodes;
}

std::vector<SupportNode> seen_from(const Vec3& x, const std::vector<Vec3>& nodes) {
  std::vector<SupportNode> seen;
  for (const Vec3& y : nodes) seen.push_back(direct_support(x, y, support));
  return seen;
}

// φ_j(x) by its definition, pᵀ M⁻¹ p_j w_j with p = (1, x).
Eigen::VectorXd shape_values(const Vec3& x, const std::vector<Vec3>& nodes) {
  const auto basis = [](const Vec3& y) { return Eigen::Vector4d(1, y.x(), y.y(), y.z()); };
  const auto weight = [&](const Vec3& y) {
    const double s = (x - y).norm() / support;
    return 1 - 6 * s * s + 8 * s * s * s - 3 * s * s * s * s;
  };
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  for (const Vec3& y : nodes) m += weight(y) * basis(y) * basis(y).transpose();
  const Eigen::Vector4d b = m.inverse() * basis(x);
  Eigen::VectorXd values(Eigen::Index(nodes.size()));
  for (std::size_t j = 0; j < nodes.size(); ++j) values[Eigen::Index(j)] = b.dot(basis(nodes[j])) * weight(nodes[j]);
  return values;
}

}  // namespace

TEST_CASE("the kernel integrates to 1 and vanishes at its radius", "[shape]") {
  const double h = 0.7;
  double sum = 0;
  constexpr int steps = 2000;
  for (int i = 0; i < steps; ++i) {
    const double r = (i + 0.5) * h / steps;
    sum += 4 * std::numbers::pi * r * r * kernel(r, h) * h / steps;
  }
  CHECK(sum == Approx(1).epsilon(1e-5));
  CHECK(kernel(h, h) == 0);
  CHECK(kernel(2 * h, h) == 0);
  CHECK(kernel(0.1, h) > kernel(0.2, h));
  CHECK(kernel(0, 1) == Approx(315 / (64 * std::numbers::pi)));
}

TEST_CASE("shape gradients reproduce linear fields and match differences of the shape functions", "[shape]") {
  const auto [first, count] = seeds(50);
  for (std::uint64_t seed = first; seed < first + std::uint64_t(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const std::vector<Vec3> nodes = random_nodes(random, 12 + random.below(10));
    const Vec3 x = 0.1 * random.direction();
    std::vector<Vec3> gradient;
    const double condition = shape_gradients(x, seen_from(x, nodes), gradient);
    REQUIRE(gradient.size() == nodes.size());
    CHECK(condition > 1);
    Vec3 sum = Vec3::Zero();
    Mat3 linear = Mat3::Zero();
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      sum += gradient[j];
      linear += nodes[j] * gradient[j].transpose();
    }
    CHECK(sum.norm() < 1e-12);
    CHECK((linear - Mat3::Identity()).norm() < 1e-10);
    const double h = 1e-6;
    for (int a = 0; a < 3; ++a) {
      const Eigen::VectorXd difference =
          (shape_values(x + h * Vec3::Unit(a), nodes) - shape_values(x - h * Vec3::Unit(a), nodes)) / (2 * h);
      for (std::size_t j = 0; j < nodes.size(); ++j)
        CHECK(gradient[j][a] == Approx(difference[Eigen::Index(j)]).epsilon(1e-4).margin(1e-5));
    }
  }
}

TEST_CASE("a bound of the condition number decides as the number itself, also for nearly coplanar nodes", "[shape]") {
  const auto [first, count] = seeds(2000);
  std::size_t bounds = 0;
  for (std::uint64_t seed = first; seed < first + std::uint64_t(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    std::vector<Vec3> nodes = random_nodes(random, 4 + random.below(20));
    const double flat = std::pow(10.0, -10 * random.uniform() * random.uniform());
    for (Vec3& y : nodes) y.z() *= flat;
    const Vec3 x = 0.1 * flat * random.direction();
    constexpr double enough = 500;
    std::vector<Vec3> gradient, same;
    const double condition = shape_gradients(x, seen_from(x, nodes), gradient);
    const double bound = shape_gradients(x, seen_from(x, nodes), same, nullptr, enough);
    CHECK((bound <= enough) == (condition <= enough));
    CHECK(bound >= (1 - 1e-9) * condition);
    CHECK(same == gradient);
    bounds += bound != condition;
  }
  CHECK(bounds > 0);
}

TEST_CASE("too few nodes, and coplanar ones, have no shape gradients", "[shape]") {
  const Vec3 x(0.1, 0.1, 0);
  std::vector<Vec3> gradient(3), nodes{{0, 0, 0}, {0.3, 0, 0}, {0, 0.3, 0}};
  CHECK(std::isinf(shape_gradients(x, seen_from(x, nodes), gradient)));
  CHECK(gradient.empty());
  nodes.insert(nodes.end(), {{0.3, 0.3, 0}, {0.2, 0.1, 0}});
  CHECK(std::isinf(shape_gradients(x, seen_from(x, nodes), gradient)));
  nodes.push_back({0, 0, 0.3});
  CHECK(std::isfinite(shape_gradients(x, seen_from(x, nodes), gradient)));
}
