// Moving-least-squares gradients at nodes, and the penalty on zero-energy modes.
#include "mechanics/discretisation/nodal_gradients.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "base/random.h"
#include "cases.h"
#include "kerf/parallel.h"
#include "mechanics/bodies.h"
#include "mechanics/discretisation/deformation.h"
#include "simd_targets.h"

using namespace geo;

namespace {

NodalGradientOperator operator_of(const Body& body) {
  std::vector<NodeId> all;
  for (std::uint32_t i = 0; i < body.nodes.size(); ++i) all.push_back(NodeId(i));
  NodalGradientOperator gradients;
  gradients.update(body.nodes, body.graph, all);
  return gradients;
}

std::vector<Vec3> random_field(Random& random, std::size_t count) {
  std::vector<Vec3> u;
  for (std::size_t i = 0; i < count; ++i) u.push_back(random.direction());
  return u;
}

}  // namespace

TEST_CASE("Eq. 1 reproduces an affine motion, and falls back on the first node's", "[nodes]") {
  const Body body = block_body({1, 0.8, 0.6}, 0.2);
  const NodalGradientOperator gradients = operator_of(body);
  Mat3 linear;
  linear << 0.1, 0.2, 0, -0.3, 0.1, 0.4, 0.2, 0, 0.5;
  const Vec3 shift(1, 2, 3), x(0.4, 0.3, 0.2);
  std::vector<Vec3> u;
  for (const Vec3& p : body.nodes.position) u.push_back(linear * p + shift);
  std::vector<std::pair<NodeId, double>> nodes;
  for (std::uint32_t i = 0; i < u.size(); ++i) nodes.push_back({NodeId(i), (x - body.nodes.position[i]).norm()});
  NodeSet set = body.nodes;
  CHECK((displacement_at(x, nodes, set, u, {gradients, u}) - (linear * x + shift)).norm() < 1e-13);
  set.radius.assign(u.size(), 1e-6);  // no kernel reaches x
  std::sort(nodes.begin(), nodes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const std::size_t first = nodes[0].first.index();
  const Vec3 expected = u[first] + linear * (x - set.position[first]);
  CHECK((displacement_at(x, nodes, set, u, {gradients, u}) - expected).norm() < 1e-13);
}

TEST_CASE("Eq. 1 follows a rotation anywhere, and amplifies no motion beyond its bound", "[nodes]") {
  const Seeds all = seeds(40);
  for (std::uint64_t seed = all.first; seed < all.first + static_cast<std::uint64_t>(all.count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    // Nodes in a film as thin as a thirtieth of their distance: their gradients amplify.
    const double thickness = std::pow(10, random.uniform(-1.5, 0));
    Body body = block_body({1, 0.8, 0.6}, 0.2);
    for (Vec3& p : body.nodes.position) p.z() *= thickness;
    NodalGradientOperator gradients = operator_of(body);
    const Vec3 axis = random.direction();
    const Mat3 rotation = Eigen::AngleAxisd(random.uniform(0, 3), axis).toRotationMatrix();
    // In the thinnest films, it decides about directions in which there is no gradient.
    gradients.set_rotations(std::vector<Mat3>(body.nodes.size(), rotation));
    std::vector<Vec3> turned, noise;
    for (const Vec3& p : body.nodes.position) {
      turned.push_back(rotation * p - p);
      noise.push_back(random.direction());
    }
    const LazyNodalGradients of_turned(gradients, turned), of_noise(gradients, noise);
    for (int k = 0; k < 20; ++k) {
      const Vec3 x(random.uniform(-0.5, 1.5), random.uniform(-0.5, 1.5), random.uniform(-0.5, 1.5));
      std::vector<std::pair<NodeId, double>> nodes;
      for (std::uint32_t i = 0; i < turned.size(); ++i)
        nodes.push_back({NodeId(i), (x - body.nodes.position[i]).norm()});
      std::sort(nodes.begin(), nodes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
      nodes.resize(8);
      const Vec3 expected = rotation * x - x;
      CHECK((displacement_at(x, nodes, body.nodes, turned, of_turned) - expected).norm() < 1e-9 / thickness);
      // A rotation moves x by at most twice its distance from a node.
      CHECK(displacement_at(x, nodes, body.nodes, noise, of_noise).norm() <
            1 + most_amplified + 2 * nodes.back().second);
    }
  }
}

TEST_CASE("gradients at nodes are exact for linear fields, and all ways to compute them agree", "[nodes]") {
  const Body body = block_body({1, 0.8, 0.6}, 0.2);
  const NodalGradientOperator gradients = operator_of(body);
  REQUIRE(gradients.size() == body.nodes.size());
  Mat3 linear;
  linear << 0.1, 0.2, 0, -0.3, 0.1, 0.4, 0.2, 0, 0.5;
  std::vector<Vec3> u;
  for (const Vec3& x : body.nodes.position) u.push_back(linear * x + Vec3(5, 6, 7));
  Random random(1);
  const std::vector<Vec3> v = random_field(random, u.size());
  for (const auto& field : {u, v})
    for_each_simd_target([&] {
      const auto all = gradients.gradients(field);
      const auto padded = gradients.padded_gradients(field);
      const LazyNodalGradients lazy(gradients, field);
      std::vector<Mat3> threaded(all.size());
      parallel_for(2 * all.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
          if (const Mat3 g = lazy[k / 2]; k % 2) threaded[k / 2] = g;
      });
      for (std::size_t i = 0; i < all.size(); ++i) {
        CHECK((all[i] - gradients.gradient(i, field)).norm() < 1e-12 * (1 + all[i].norm()));
        CHECK(threaded[i] == gradients.gradient(i, field));
        const ShapeGradients shape = gradients.shape_gradients(i);
        CHECK(std::is_sorted(shape.nodes.begin(), shape.nodes.end()));
        Mat3 sum = Mat3::Zero();
        for (std::size_t q = 0; q < shape.nodes.size(); ++q)
          sum += field[shape.nodes[q]] * shape.gradient[q].transpose();
        CHECK((sum - all[i]).norm() < 1e-10 * (1 + all[i].norm()));
        for (std::size_t c = 0; c < 3; ++c) {
          CHECK(padded[i].at[c][3] == 0);
          for (std::size_t r = 0; r < 3; ++r) CHECK(padded[i].at[c][r] == all[i](Eigen::Index(r), Eigen::Index(c)));
        }
      }
    });
  for (std::size_t i = 0; i < u.size(); ++i) {
    REQUIRE(gradients.quality(i) == MomentQuality::good);
    CHECK((gradients.gradient(i, u) - linear).norm() < 1e-12);
  }
}

TEST_CASE("the displacement at a node in vector registers is that of Eq. 1", "[nodes]") {
  const Body body = block_body({1, 0.8, 0.6}, 0.2);
  const NodalGradientOperator gradients = operator_of(body);
  const std::size_t n = body.nodes.size();
  Random random(2);
  const std::vector<Vec3> u = random_field(random, n);
  const auto gradient = gradients.padded_gradients(u);
  const LazyNodalGradients lazy(gradients, u);
  std::vector<PaddedVec3> place, displacement;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3& x = body.nodes.position[i];
    place.push_back({x[0], x[1], x[2], 1 / (body.nodes.radius[i] * body.nodes.radius[i])});
    displacement.push_back({u[i][0], u[i][1], u[i][2], 0});
  }
  for_each_simd_target([&] {
    for (std::uint32_t i = 0; i < n; ++i) {
      std::vector<std::pair<NodeId, double>> nodes{{NodeId(i), 0}};
      for (const auto j : gradients[i].neighbors)
        nodes.push_back({NodeId(j), (body.nodes.position[j] - body.nodes.position[i]).norm()});
      const PaddedVec3 blended =
          blended_displacement(gradients[i].neighbors, {place.data(), displacement.data(), gradient.data()}, i);
      const Vec3 expected = displacement_at(body.nodes.position[i], nodes, body.nodes, u, lazy);
      CHECK((Vec3(blended.at[0], blended.at[1], blended.at[2]) - expected).norm() < 1e-12);
    }
  });
}

TEST_CASE("the mode penalty vanishes for affine fields, and its derivative matches differences", "[nodes]") {
  const Body body = block_body({1, 0.8, 0.6}, 0.25);
  const NodalGradientOperator gradients = operator_of(body);
  const std::size_t n = body.nodes.size();
  Random random(3);
  std::vector<double> weight;
  for (std::size_t i = 0; i < n; ++i) weight.push_back(random.uniform(1, 2));
  const ModePenalty penalty(gradients, weight);
  std::vector<Vec3> affine;
  for (const Vec3& x : body.nodes.position) affine.push_back(Vec3(x.y() + 2, 3 * x.z(), -x.x()));
  const std::vector<Vec3> u = random_field(random, n), v = random_field(random, n);
  CHECK(penalty.add(gradients, affine, nullptr) < 1e-24);
  std::vector<Vec3> derivative(n, Vec3::Zero());
  const double energy = penalty.add(gradients, u, &derivative);
  CHECK(energy > 1);
  // A quadratic form: central differences are exact.
  std::vector<Vec3> plus = u, minus = u;
  double slope = 0;
  for (std::size_t i = 0; i < n; ++i) {
    plus[i] += v[i];
    minus[i] -= v[i];
    slope += derivative[i].dot(v[i]);
  }
  CHECK(0.5 * (penalty.add(gradients, plus, nullptr) - penalty.add(gradients, minus, nullptr)) ==
        Approx(slope).epsilon(1e-10).margin(1e-10));
  std::vector<double> diagonal(n, 0);
  penalty.add_diagonal(gradients, diagonal);
  for (const double d : diagonal) CHECK(d > 0);
}
