#include <Eigen/Geometry>
#include <Eigen/LU>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "kerf/solid.h"
#include "mechanics/bodies.h"
#include "mechanics/discretisation/deformation.h"
#include "mechanics/solver/solid_discretisation.h"

using namespace geo;

TEST_CASE("Nodes of a linear field move with it and have its stress") {
  for (const auto discretisation : {Discretisation::galerkin, Discretisation::mueller04}) {
    const Body body = block_body({2, 1, 1}, 0.2);
    Material m;
    m.discretisation = discretisation;
    Solid solid(body, m);
    Random random(5);
    Mat3 slope;
    for (int k = 0; k < 9; ++k) slope.data()[k] = 0.1 * random.uniform(-1, 1);
    const Vec3 shift(0.3, -0.2, 0.1);
    State state;
    for (const Vec3& x : body.nodes.position) state.displacement.push_back(shift + slope * x);
    const auto moved = material_displacement(solid, body.nodes, body.graph, state);
    for (std::size_t i = 0; i < moved.size(); ++i) CHECK((moved[i] - state.displacement[i]).norm() < 1e-9);
    const Mat3 f = Mat3::Identity() + slope, cauchy = stress(m, f) * f.transpose() / f.determinant();
    const Mat3 deviator = cauchy - cauchy.trace() / 3 * Mat3::Identity();
    for (const double s : von_mises_stress(solid, body.nodes, state))
      CHECK(s == Approx(std::sqrt(1.5) * deviator.norm()).epsilon(1e-6));
  }
}

TEST_CASE("Nodes are moved by Eq. 1, whatever they do") {
  const Body body = block_body({1.5, 1, 0.7}, 0.15);
  Solid solid(body, {});
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    INFO("seed " << seed);
    Random random(seed);
    State state;
    for (std::size_t i = 0; i < body.nodes.size(); ++i)
      state.displacement.push_back(random.uniform(0, 0.3) * random.direction());
    const auto moved = material_displacement(solid, body.nodes, body.graph, state);
    const auto gradients = solid.gradients(state.displacement);
    const LazyNodalGradients gradient = lazy_gradients(SolidDiscretisation::of(solid), state.displacement);
    for (std::uint32_t i = 0; i < moved.size(); ++i) {
      CHECK((gradients[i] - gradient[i]).norm() < 1e-12);
      std::vector<std::pair<NodeId, double>> nodes{{NodeId(i), 0.0}};
      for (const auto& n : body.graph.neighbors(body.nodes, NodeId(i)))
        nodes.emplace_back(n.to, (body.nodes.position[n.to.index()] - body.nodes.position[i]).norm());
      std::erase_if(nodes, [&](const auto& n) { return !(n.second < body.nodes.radius[n.first.index()]); });
      CHECK(
          (moved[i] - displacement_at(body.nodes.position[i], nodes, body.nodes, state.displacement, gradient)).norm() <
          1e-12);
    }
  }
}

TEST_CASE("A node of a crowd that is away from it does not take its material along") {
  const Body body = block_body({2, 1, 1}, 0.2);
  Solid solid(body, {});
  State state{std::vector<Vec3>(body.nodes.size(), Vec3::Zero()), {}};
  state.displacement[body.nodes.size() / 2] = Vec3(1, 0, 0);
  double farthest = 0;
  for (const Vec3& u : material_displacement(solid, body.nodes, body.graph, state))
    farthest = std::max(farthest, u.norm());
  CHECK(farthest > 0);
  CHECK(farthest < 0.5);
}

TEST_CASE("Plastic strain carries no stress") {
  const Body body = block_body({1, 1, 1}, 0.2);
  Solid solid(body, {});
  State state{{}, {}};
  for (const Vec3& x : body.nodes.position) state.displacement.push_back({0.2 * x.x(), 0, 0});
  Mat3 plastic = Mat3::Zero();
  plastic(0, 0) = 0.5 * (1.2 * 1.2 - 1);
  state.plastic.assign(solid.point_count(), plastic);
  for (const double s : von_mises_stress(solid, body.nodes, state)) CHECK(s < 1e-6 * solid.materials()[0].young);
}

TEST_CASE("A body that has turned and is far away has no stress") {
  const Body body = block_body({2, 1, 1}, 0.1);
  Solid solid(body, {});
  const Mat3 turn = Eigen::AngleAxisd(1.5, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  State state{{}, {}};
  for (const Vec3& x : body.nodes.position) state.displacement.push_back(Vec3(300, -20, 7) + turn * x - x);
  for (const double s : von_mises_stress(solid, body.nodes, state)) CHECK(s < 1e-10 * solid.materials()[0].young);
}
