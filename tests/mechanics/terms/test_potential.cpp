// Potentials and their sum against dense matrices.
#include "kerf/potential.h"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include "assembled_potential.h"
#include "base/random.h"
#include "cases.h"
#include "mechanics/terms/stencil_matrix.h"
#include "mechanics/terms/weighted_sums.h"
#include "simd_targets.h"

using namespace geo;

namespace {

// Springs between relative displacements and 0, with a symmetric positive stiffness each.
struct Springs : Potential {
  std::vector<std::vector<NodeWeight>> stencils;
  std::vector<Mat3> stiffness;
  bool inside_components = false;

  std::size_t size() const override { return stencils.size(); }
  Stencil stencil(std::size_t k) const override { return stencils[k]; }
  bool within_components() const override { return inside_components; }
  double energy(std::size_t k, const Vec3& d) const override { return 0.5 * d.dot(stiffness[k] * d); }
  Derivatives derivatives(std::size_t k, const Vec3& d) const override { return {-stiffness[k] * d, stiffness[k]}; }
  double stiffness_bound(std::size_t k) const override { return stiffness[k].trace(); }
};

Springs random_springs(Random& random, std::uint32_t nodes, std::size_t count) {
  Springs springs;
  for (std::size_t k = 0; k < count; ++k) {
    auto& stencil = springs.stencils.emplace_back();
    for (std::uint32_t i = random.below(3); i < nodes; i += 1 + random.below(6))
      stencil.push_back({i, random.uniform(-1, 1)});
    const Vec3 n = random.direction();
    springs.stiffness.push_back(random.uniform(1, 4) * n * n.transpose() + 0.1 * Mat3::Identity());
  }
  return springs;
}

std::vector<Vec3> random_vectors(Random& random, std::size_t count) {
  std::vector<Vec3> v;
  for (std::size_t i = 0; i < count; ++i) v.push_back(random.direction());
  return v;
}

// ∂²E/∂u² as a dense matrix.
Eigen::MatrixXd dense(const Springs& springs, Eigen::Index nodes) {
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(3 * nodes, 3 * nodes);
  for (std::size_t s = 0; s < springs.size(); ++s)
    for (const auto& a : springs.stencils[s])
      for (const auto& b : springs.stencils[s])
        k.block<3, 3>(3 * Eigen::Index(a.node), 3 * Eigen::Index(b.node)) += a.weight * b.weight * springs.stiffness[s];
  return k;
}

Eigen::VectorXd flat(const std::vector<Vec3>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v[0].data(), 3 * Eigen::Index(v.size()));
}

}  // namespace

TEST_CASE("weighted sums and norms of a stencil", "[potential]") {
  const std::vector<NodeWeight> stencil{{2, 0.5}, {0, -2}};
  const std::vector<Vec3> values{{1, 0, 0}, {9, 9, 9}, {0, 4, 0}};
  CHECK(weighted_sum(stencil, values) == Vec3(-2, 2, 0));
  CHECK(weight_norm(stencil) == 2.5);
  CHECK(weighted_sum({}, values) == Vec3(0, 0, 0));
}

TEST_CASE("weighted sums of many stencils are those of each, bit for bit", "[potential]") {
  const auto [first, count] = seeds(20);
  for (std::uint64_t seed = first; seed < first + std::uint64_t(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Springs springs = random_springs(random, 30, 1 + random.below(40));
    const std::vector<Vec3> values = random_vectors(random, 30);
    for_each_simd_target([&] {
      std::vector<Vec3> sums(springs.size(), Vec3::Constant(-1));
      for_each_weighted_sum(
          springs.size(), values, [&](std::size_t k) { return springs.stencil(k); },
          [&](std::size_t k, const Vec3& sum) { sums[k] = sum; });
      for (std::size_t k = 0; k < sums.size(); ++k) CHECK(sums[k] == weighted_sum(springs.stencil(k), values));
    });
  }
}

TEST_CASE("a stencil matrix has the same entries by stencil and by node", "[potential]") {
  const auto [first, count] = seeds(20);
  for (std::uint64_t seed = first; seed < first + std::uint64_t(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    constexpr std::uint32_t nodes = 25;
    const Springs springs = random_springs(random, nodes, 1 + random.below(1500));
    const std::vector<Stencil> stencils(springs.stencils.begin(), springs.stencils.end());
    std::vector<std::uint32_t> selected;
    for (std::uint32_t k = 0; k < stencils.size(); ++k)
      if (random.below(3) > 0) selected.push_back(k);
    const StencilMatrix matrix(selected, stencils, nodes);
    REQUIRE(matrix.size() == selected.size());
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(Eigen::Index(stencils.size()), nodes), by_stencil = expected,
                    by_node = expected, precise = expected;
    for (const auto k : selected)
      for (const auto& e : stencils[k]) expected(k, e.node) = e.weight;
    for (std::size_t k = 0; k < matrix.size(); ++k) {
      CHECK(matrix.stencil(k) == selected[k]);
      for (const auto& e : matrix.nodes_of(k)) by_stencil(matrix.stencil(k), e.index) += e.weight;
    }
    for (std::uint32_t i = 0; i < nodes; ++i) {
      const auto entries = matrix.stencils_of(i);
      for (std::size_t k = 0; k < entries.size(); ++k) {
        CHECK((k == 0 || entries[k - 1].index < entries[k].index));
        by_node(entries[k].index, i) += entries[k].weight;
        precise(entries[k].index, i) += matrix.weights_of(i)[k];
      }
    }
    CHECK((by_stencil - expected.cast<float>().cast<double>()).norm() == 0);
    CHECK((by_node - by_stencil).norm() == 0);
    CHECK((precise - expected).norm() == 0);
  }
  CHECK(StencilMatrix().stencils_of(7).empty());
}

TEST_CASE("a sum of potentials has the dense matrix' energy, forces, products and bound", "[potential]") {
  const auto [first, count] = seeds(20);
  for (std::uint64_t seed = first; seed < first + std::uint64_t(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    constexpr std::uint32_t nodes = 12;
    Springs springs = random_springs(random, nodes, 1 + random.below(30));
    const std::vector<Vec3> start(nodes, Vec3::Zero()), u = random_vectors(random, nodes),
                                                        p = random_vectors(random, nodes);
    const Eigen::MatrixXd k = dense(springs, nodes);
    AssembledPotential assembled(springs, start);
    CHECK(assembled.energy(u) == Approx(0.5 * flat(u).dot(k * flat(u))));
    CHECK((flat(assembled.force(u)) + k * flat(u)).norm() < 1e-12 * (1 + k.norm()));
    CHECK((flat(assembled.product(p)) - k * flat(p)).norm() < 1e-5 * (1 + k.norm()));
    // Gershgorin's bound of M⁻¹ K, with a fixed node.
    std::vector<double> inverse_mass;
    for (std::uint32_t i = 0; i < nodes; ++i) inverse_mass.push_back(i == 3 ? 0 : random.uniform(0.5, 2));
    Eigen::VectorXd root(3 * nodes);
    for (Eigen::Index i = 0; i < 3 * nodes; ++i) root[i] = std::sqrt(inverse_mass[std::size_t(i / 3)]);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
        Eigen::MatrixXd(root.asDiagonal() * k * root.asDiagonal()), Eigen::EigenvaluesOnly);
    CHECK(springs.eigenvalue_bound(inverse_mass) >= eigen.eigenvalues().maxCoeff() * (1 - 1e-12));
  }
}

TEST_CASE("a sum of potentials evaluates selected islands only, and names the components that it couples",
          "[potential]") {
  Springs springs;
  springs.stencils = {{{0, 1}, {1, -1}}, {{2, 1}}, {}};
  springs.stiffness.assign(3, 2 * Mat3::Identity());
  const std::vector<Vec3> start(3, Vec3::Zero());
  Potential* const potentials[] = {&springs};
  PotentialSum sum(potentials, start);
  REQUIRE_FALSE(sum.empty());
  const std::vector<std::uint32_t> component{5, 6, 7}, island{0, 0, 1};
  CHECK(sum.coupled_components(component) == std::vector<std::pair<std::uint32_t, std::uint32_t>>{{5, 6}});
  const std::vector<Vec3> u{{1, 0, 0}, {0, 0, 0}, {0, 3, 0}};
  std::vector<double> energy(2, 0);
  sum.add_energy(u, island, {0, 1}, energy);
  CHECK(energy == std::vector<double>{0, 9});
  sum.update_derivatives(island, {0, 1});
  CHECK(sum.force_at(0) == Vec3(0, 0, 0));
  CHECK(sum.force_at(2) == Vec3(0, -6, 0));
  CHECK_FALSE(sum.acts_on(0));
  CHECK(sum.acts_on(2));
  sum.add_energy(u, island, {1, 0}, energy);
  CHECK(energy == std::vector<double>{1, 9});
  sum.update_derivatives(island, {1, 0});
  CHECK(sum.force_at(1) == Vec3(2, 0, 0));
  CHECK(sum.force_at(2) == Vec3(0, -6, 0));

  springs.inside_components = true;
  CHECK(PotentialSum(potentials, start).coupled_components(component).empty());
  CHECK(PotentialSum({}, start).empty());
}
