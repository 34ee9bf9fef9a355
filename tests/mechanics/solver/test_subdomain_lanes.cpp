// Inverses of the stiffness of eight subdomains side by side, beside dense ones.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.h"
#include "cases.h"
#include "mechanics/solver/subdomain_lanes.h"
#include "simd_targets.h"

using namespace geo;

namespace {

struct DenseSubdomain {
  Eigen::MatrixXf stiffness;  // as its tiles and blocks say; zero for fixed nodes
  Eigen::VectorXf share;
};

Eigen::Vector3f any_vector(Random& random) {
  return Eigen::Vector3f::NullaryExpr([&] { return static_cast<float>(random.uniform(-1, 1)); });
}

// Points with gradients at random of up to all nodes; a block for each free node; magnitudes
// far apart from subdomain to subdomain.
DenseSubdomain put_any(Random& random, std::size_t lane, EightSubdomains& to) {
  const auto nodes = 1 + random.below(to.nodes);
  const float scale = static_cast<float>(std::pow(10, random.uniform(-3, 6)));
  const Eigen::Matrix3f turn =
      Eigen::Quaternionf(Eigen::Vector4f::NullaryExpr([&] { return static_cast<float>(random.uniform(-1, 1)); }))
          .normalized()
          .toRotationMatrix();
  for (std::size_t k = 0; k < 9; ++k) to.turn[8 * k + lane] = turn.data()[k];
  const float shear = to.shear[lane] = scale * static_cast<float>(random.uniform(0.1, 1)),
              bulk = to.bulk[lane] = scale * static_cast<float>(random.uniform(0, 5));
  DenseSubdomain p{Eigen::MatrixXf::Zero(Eigen::Index(3 * nodes), Eigen::Index(3 * nodes)),
                   Eigen::VectorXf::Zero(Eigen::Index(nodes))};
  std::vector<bool> fixed;
  std::vector<Eigen::MatrixXf> points;  // gradients as columns
  for (std::size_t a = 0; a < nodes; ++a) fixed.push_back(random.below(5) == 0);
  for (std::size_t k = 0; k < 2 * nodes; ++k)
    points.push_back(Eigen::MatrixXf::NullaryExpr(3, Eigen::Index(nodes),
                                                  [&] { return static_cast<float>(random.uniform(-1, 1)); }));
  for (std::size_t a = 0; a < nodes; ++a) {
    if (fixed[a]) continue;
    const Eigen::Index i = Eigen::Index(a);
    p.share[i] = to.share[8 * a + lane] = static_cast<float>(random.uniform(0.1, 1));
    const Eigen::Vector3f any = any_vector(random);
    const Eigen::Matrix3f block = scale * (0.1f * Eigen::Matrix3f::Identity() + 10 * any * any.transpose());
    for (std::size_t k = 0; k < 9; ++k) to.blocks[72 * a + 8 * k + lane] = block.data()[k];
    p.stiffness.block<3, 3>(3 * i, 3 * i) += turn.transpose() * block * turn;
    for (std::size_t b = 0; b <= a; ++b) {
      if (fixed[b]) continue;
      const Eigen::Index j = Eigen::Index(b);
      Eigen::Matrix3f outer = Eigen::Matrix3f::Zero();
      for (const auto& g : points) outer += g.col(i) * g.col(j).transpose();
      for (std::size_t k = 0; k < 9; ++k)
        to.tiles[72 * (a * (a + 1) / 2 + b) + 8 * k + lane] = outer(Eigen::Index(k / 3), Eigen::Index(k % 3));
      const Eigen::Matrix3f tile =
          bulk * outer + shear * outer.transpose() + shear * outer.trace() * Eigen::Matrix3f::Identity();
      p.stiffness.block<3, 3>(3 * i, 3 * j) += tile;
      if (a != b) p.stiffness.block<3, 3>(3 * j, 3 * i) += tile.transpose();
    }
  }
  return p;
}

Eigen::MatrixXd got(const EightSubdomains& from, std::size_t lane, Eigen::Index size) {
  Eigen::MatrixXd m(size, size);
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) {
      const auto a = static_cast<std::size_t>(i / 3), b = static_cast<std::size_t>(j / 3);
      const auto half =
          from.halves[72 * (a * (a + 1) / 2 + b) + 8 * static_cast<std::size_t>(3 * (i % 3) + j % 3) + lane];
      m(i, j) = m(j, i) = std::bit_cast<float>(std::uint32_t(half) << 16);
    }
  return m;
}

// By eigenvectors, without those of fixed nodes.
Eigen::MatrixXd expected(const DenseSubdomain& p) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> s(p.stiffness.cast<double>());
  const Eigen::VectorXd over =
      s.eigenvalues().unaryExpr([&](double x) { return x > 1e-6 * s.eigenvalues().maxCoeff() ? 1 / x : 0; });
  Eigen::MatrixXd m = s.eigenvectors() * over.asDiagonal() * s.eigenvectors().transpose();
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    for (Eigen::Index j = 0; j < m.rows(); ++j) m(i, j) *= double(p.share[i / 3]) * double(p.share[j / 3]);
  return m;
}

}  // namespace

TEST_CASE("Eight subdomains are inverted as each on its own, in all vectors, and fixed nodes have no part in it",
          "[mechanics]") {
  const auto [first_seed, count] = seeds(100);
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(i);
    CAPTURE(seed);
    Random random(seed);
    EightSubdomains made;
    made.begin(1 + random.below(12));
    std::vector<DenseSubdomain> subdomains;
    for (std::size_t lane = random.below(3); lane < 8; ++lane) subdomains.push_back(put_any(random, lane, made));
    for_each_simd_target([&] {
      EightSubdomains eight = made;
      invert_positive(eight);
      for (std::size_t k = 0; k < subdomains.size(); ++k) {
        const Eigen::MatrixXd wanted = expected(subdomains[k]),
                              inverse = got(eight, 8 - subdomains.size() + k, wanted.rows());
        const Eigen::VectorXd size = wanted.diagonal().cwiseSqrt();
        for (Eigen::Index r = 0; r < wanted.rows(); ++r)
          for (Eigen::Index c = 0; c <= r; ++c)
            if (!(std::abs(inverse(r, c) - wanted(r, c)) <= 0.005 * size[r] * size[c]))
              FAIL_CHECK("subdomain " << k << ", " << r << " " << c << ": " << inverse(r, c) << ", not "
                                      << wanted(r, c));
      }
    });
  }
}

TEST_CASE("A linearly dependent row of a subdomain is left out", "[mechanics]") {
  EightSubdomains eight;
  eight.begin(2);
  eight.shear.fill(1);
  std::fill(eight.share.begin(), eight.share.end(), 1.0f);
  for (const std::size_t k : {0, 4, 8})
    for (std::size_t l = 0; l < 8; ++l) {
      eight.turn[8 * k + l] = 1;
      for (std::size_t a = 0; a < 2; ++a) eight.blocks[72 * a + 8 * k + l] = 2;
      if (k == 4) eight.tiles[72 + 8 * k + l] = 1;  // 2 along y, 1 along x and z
    }
  for_each_simd_target([&] {
    EightSubdomains inverse = eight;
    invert_positive(inverse);
    for (std::size_t l = 0; l < 8; ++l) {
      const Eigen::MatrixXd m = got(inverse, l, 6);
      Eigen::VectorXd diagonal(6);
      diagonal << 2 / 3.0, 0.5, 2 / 3.0, 2 / 3.0, 0, 2 / 3.0;
      CHECK((m.diagonal() - diagonal).norm() < 0.01);
      CHECK(m(1, 4) == 0);
      CHECK(m(0, 3) == Approx(-1 / 3.0).epsilon(0.01));
    }
  });
}
