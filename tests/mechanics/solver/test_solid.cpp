#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <optional>

#include "base/random.h"
#include "graph/build_graph.h"
#include "graph/graph_storage.h"
#include "kerf/graph.h"
#include "kerf/parallel.h"
#include "kerf/solid.h"
#include "mechanics/discretisation/deformation.h"
#include "mechanics/solver/solid_discretisation.h"

using namespace geo;

namespace {

struct Bar {
  NodeSet nodes;
  VisibilityGraph graph;
};

// A jittered grid of nodes; neighbours are all within the support.
Bar bar(int nx, int ny, int nz, double jitter, std::uint64_t seed = 1) {
  Bar b;
  Random random(seed);
  const double h = 1.0 / ny;
  for (int i = 0; i < nx * ny * nz; ++i) {
    const Vec3 p(i % nx, i / nx % ny, i / nx / ny);
    b.nodes.position.push_back(
        h *
        (p + Vec3::Constant(0.5) + jitter * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1))));
    b.nodes.radius.push_back(1.9 * h);
    b.nodes.spacing.push_back(h);
    b.nodes.volume.push_back(h * h * h);
  }
  GraphStorage::of(b.graph).resize(b.nodes.size());
  for (std::uint32_t i = 0; i < b.nodes.size(); ++i)
    for (std::uint32_t j = 0; j < i; ++j)
      if ((b.nodes.position[i] - b.nodes.position[j]).norm() < b.nodes.radius[i])
        GraphStorage::of(b.graph).add(b.nodes, i, j);
  build_neighborhoods(b.nodes, b.graph, TriangleBvh());
  return b;
}

State at_rest(const Bar& b) {
  return {std::vector<Vec3>(b.nodes.size(), Vec3::Zero()), std::vector<Vec3>(b.nodes.size(), Vec3::Zero())};
}

Material material(ElasticModel model) {
  Material m;
  m.model = model;
  m.young = 1e5;
  m.poisson = 0.3;
  m.density = 1000;
  m.damping = 0;
  m.volume_term = 3e4;
  return m;
}

}  // namespace

TEST_CASE("stress is the derivative of energy, and its derivative that of stress") {
  for (const auto model : {ElasticModel::saint_venant_kirchhoff, ElasticModel::neo_hookean}) {
    const Material m = material(model);
    Random random(3);
    for (int i = 0; i < 50; ++i) {
      Mat3 f = Mat3::Identity(), d;
      for (int k = 0; k < 9; ++k) {
        f.data()[k] += 0.3 * random.uniform(-1, 1);
        d.data()[k] = random.uniform(-1, 1);
      }
      const double e = 1e-6;
      const double slope = (energy_density(m, f + e * d) - energy_density(m, f - e * d)) / (2 * e);
      CHECK((stress(m, f).array() * d.array()).sum() == Approx(slope).epsilon(1e-6).margin(1e-3));
      const Mat3 change = (stress(m, f + e * d) - stress(m, f - e * d)) / (2 * e);
      const Eigen::Matrix<double, 9, 1> product =
          stress_derivative(m, f) * Eigen::Map<const Eigen::Matrix<double, 9, 1>>(d.data());
      CHECK((Eigen::Map<const Mat3>(product.data()) - change).norm() < 1e-5 * (1 + change.norm()));
    }
    CHECK(std::abs(energy_density(m, Mat3(Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized())))) < 1e-9 * m.young);
  }
}

TEST_CASE("rigid motion costs nothing and linear fields are exact on jittered nodes") {
  const Bar b = bar(6, 4, 4, 0.25);
  Solid solid(b.nodes, b.graph, material(ElasticModel::neo_hookean));
  const Mat3 turn = Eigen::AngleAxisd(0.8, Vec3(1, -1, 2).normalized()).toRotationMatrix();
  Mat3 linear;
  linear << 0.1, 0.02, -0.03, 0.01, -0.05, 0.04, 0.0, 0.06, 0.02;
  std::vector<Vec3> rigid, stretched;
  for (const auto& p : b.nodes.position) {
    rigid.push_back(turn * p - p + Vec3(3, 2, 1));
    stretched.push_back(linear * p);
  }
  CHECK(solid.energy(rigid) < 1e-12 * 1e5);
  for (const auto& f : solid.forces(rigid)) CHECK(f.norm() < 1e-8 * 1e5);
  for (const auto& g : solid.gradients(stretched)) CHECK((g - linear).norm() < 1e-10);
}

TEST_CASE("forces are minus the derivative of the energy, and sum to zero") {
  const Bar b = bar(4, 3, 3, 0.2);
  for (const auto model : {ElasticModel::saint_venant_kirchhoff, ElasticModel::neo_hookean}) {
    Solid solid(b.nodes, b.graph, material(model));
    Random random(5);
    std::vector<Vec3> u, d;
    for (std::size_t i = 0; i < b.nodes.size(); ++i) {
      u.push_back(0.05 * random.direction());
      d.push_back(random.direction());
    }
    const auto f = solid.forces(u);
    double along = 0;
    Vec3 sum = Vec3::Zero();
    auto plus = u, minus = u;
    const double e = 1e-6;
    for (std::size_t i = 0; i < u.size(); ++i) {
      along -= f[i].dot(d[i]);
      sum += f[i];
      plus[i] += e * d[i];
      minus[i] -= e * d[i];
    }
    CHECK(along == Approx((solid.energy(plus) - solid.energy(minus)) / (2 * e)).epsilon(1e-6));
    CHECK(sum.norm() < 1e-10 * 1e5);
  }
}

TEST_CASE("free fall is exact, and the same for any number of threads") {
  const Bar b = bar(4, 4, 4, 0.2);
  Material m = material(ElasticModel::neo_hookean);
  Solid solid(b.nodes, b.graph, m);
  Environment env;
  State state = at_rest(b);
  for (int i = 0; i < 10; ++i) solid.step_implicit(state, 0.01, env);
  const double fallen = -0.5 * 9.81 * 1e-4 * 10 * 11;
  for (const auto& u : state.displacement) CHECK(u.z() == Approx(fallen).epsilon(1e-6));
  set_threads(1);
  State one = at_rest(b);
  one.displacement[3] += Vec3(0.02, 0, 0);
  State many = one;
  solid.step_implicit(one, 0.01, env);
  set_threads(4);
  solid.step_implicit(many, 0.01, env);
  set_threads(0);
  CHECK(one.displacement == many.displacement);
}

TEST_CASE("a clamped bar bends and comes to rest and a crushed one recovers without NaN") {
  const Bar b = bar(12, 3, 3, 0.0);
  Material m = material(ElasticModel::neo_hookean);
  m.damping = 1.5;
  Solid solid(b.nodes, b.graph, m);
  Environment env;
  env.gravity = {0, 0, -0.05};
  for (const auto& p : b.nodes.position) env.fixed.push_back(p.x() < 0.4);
  State state = at_rest(b);
  for (int i = 0; i < 300; ++i) solid.step_implicit(state, 0.1, env);
  // Timoshenko for its own weight on the free length: w L⁴ / 8 E I plus shear.
  const double length = 4 - 1.0 / 3, w = 1000 * 0.05,
               tip = w * std::pow(length, 4) / (8 * 1e5 / 12) + w * length * length / (2 * 5.0 / 6 * m.mu());
  CHECK(-state.displacement[11].z() > 0.5 * tip);  // nodal integration is soft, never stiff by half
  CHECK(-state.displacement[11].z() < 2.5 * tip);
  CHECK(state.velocity[11].norm() < 1e-4);
  State crushed = at_rest(b);
  for (std::size_t i = 0; i < b.nodes.size(); ++i) crushed.displacement[i].x() = -1.4 * b.nodes.position[i].x();
  const double before = solid.energy(crushed.displacement);
  for (int i = 0; i < 20; ++i) solid.step_implicit(crushed, 0.02, Environment{});
  for (const auto& u : crushed.displacement) CHECK(u.allFinite());
  CHECK(solid.energy(crushed.displacement) < before);
}

TEST_CASE("few, coplanar and no neighbours give no NaN") {
  Bar b = bar(4, 4, 1, 0.0);
  b.nodes.position.push_back({50, 0, 0});
  b.nodes.radius.push_back(0.5);
  b.nodes.spacing.push_back(0.25);
  b.nodes.volume.push_back(0.01);
  GraphStorage::of(b.graph).resize(b.nodes.size());
  Solid solid(b.nodes, b.graph, material(ElasticModel::neo_hookean));
  CHECK(SolidDiscretisation::of(solid).mls.quality(0) == MomentQuality::poor);
  CHECK(SolidDiscretisation::of(solid).mls.quality(16) == MomentQuality::singular);
  State state{std::vector<Vec3>(17, Vec3::Zero()), std::vector<Vec3>(17, Vec3::Zero())};
  for (int i = 0; i < 5; ++i) solid.step_implicit(state, 0.02, Environment{});
  for (const auto& u : state.displacement) CHECK(u.allFinite());
  CHECK(state.displacement[16].z() == Approx(-0.5 * 9.81 * 4e-4 * 30).epsilon(1e-6));
}

namespace {

// Appends a node that takes half of the volume of node `donor` and sees the node `sees`, if any.
void insert_beside(Bar& b, std::uint32_t donor, const Vec3& offset, std::optional<std::uint32_t> sees) {
  b.nodes.volume[donor] *= 0.5;
  b.nodes.position.push_back(b.nodes.position[donor] + offset);
  b.nodes.radius.push_back(double(b.nodes.radius[donor]));
  b.nodes.spacing.push_back(0.2);
  b.nodes.volume.push_back(double(b.nodes.volume[donor]));
  GraphStorage::of(b.graph).resize(b.nodes.size());
  if (sees) GraphStorage::of(b.graph).add(b.nodes, *sees, static_cast<std::uint32_t>(b.nodes.size() - 1));
}

}  // namespace

TEST_CASE("momentum is conserved through insertion, also into a piece of new nodes alone") {
  const bool apart = GENERATE(false, true);
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    CAPTURE(apart, seed);
    Bar b = bar(4, 4, 4, 0.1);
    Solid solid(b.nodes, b.graph, material(ElasticModel::neo_hookean));
    State state = at_rest(b);
    Random random(seed);
    for (auto& v : state.velocity) v = random.direction();
    const Vec3 before = solid.momentum(state);
    const auto donor = static_cast<std::uint32_t>(64 * random.uniform());
    insert_beside(b, donor, {0.05, 0.03, 0.02}, apart ? std::nullopt : std::optional(donor));
    insert_beside(b, 64, {-0.02, 0.04, 0.01}, 64);
    build_neighborhoods(b.nodes, b.graph, TriangleBvh());
    const std::vector<NodeId> donors{NodeId(donor), NodeId(64u)}, updated{NodeId(64u), NodeId(65u)};
    solid.update(b.nodes, b.graph, NodeId(64u), donors, updated, state);
    CHECK((solid.momentum(state) - before).norm() < 1e-12 * before.norm());
  }
}
