// The factor of a band matrix, beside a dense one.
#include <Eigen/Cholesky>
#include <algorithm>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "mechanics/solver/band_cholesky.h"
#include "simd_targets.h"

using namespace geo;

namespace {

struct Band {
  std::vector<std::size_t> last;
  Eigen::MatrixXf matrix;
};

// Tiles at random up to `last` of each row, each row's diagonal larger than all beside it; blocks
// of rows that nothing joins.
Band random_band(Random& random) {
  Band b;
  const auto tiles = 1 + static_cast<std::size_t>(random.uniform() * 20);
  for (std::size_t g = 0; g < tiles; ++g)
    b.last.push_back(std::min(tiles - 1, g + static_cast<std::size_t>(random.uniform() * random.uniform() * 8)));
  const auto n = static_cast<Eigen::Index>(6 * tiles);
  b.matrix = Eigen::MatrixXf::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = i;
         j < std::min(n, static_cast<Eigen::Index>(6 * (b.last[static_cast<std::size_t>(i / 6)] + 1))); ++j)
      if (i != j) b.matrix(i, j) = b.matrix(j, i) = static_cast<float>(random.uniform() - 0.5);
  for (Eigen::Index i = 0; i < n; ++i) b.matrix(i, i) = 0.5f + b.matrix.row(i).cwiseAbs().sum();
  return b;
}

BandCholesky filled(const Band& b) {
  BandCholesky f(b.last);
  for (Eigen::Index i = 0; i < b.matrix.rows(); ++i)
    for (Eigen::Index j = i; j < b.matrix.rows(); ++j)
      if (b.matrix(i, j) != 0) f.at(static_cast<std::size_t>(i), static_cast<std::size_t>(j)) = b.matrix(i, j);
  return f;
}

}  // namespace

TEST_CASE("A band matrix's factor solves as a dense one does, with the same numbers in all vectors", "[mechanics]") {
  const auto [first_seed, count] = seeds(300);
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(i);
    CAPTURE(seed);
    Random random(seed);
    const Band b = random_band(random);
    Eigen::VectorXf right(b.matrix.rows());
    for (auto& x : right) x = static_cast<float>(random.uniform() - 0.5);
    const Eigen::VectorXd expected = b.matrix.cast<double>().llt().solve(right.cast<double>());
    Eigen::VectorXf first;
    for_each_simd_target([&] {
      BandCholesky f = filled(b);
      f.factor();
      Eigen::VectorXf x = right;
      f.solve(x.data());
      CHECK((x.cast<double>() - expected).norm() <= 1e-5 * expected.norm());
      if (first.size() == 0) first = x;
      CHECK(x == first);
    });
  }
}

TEST_CASE("What a band matrix cannot tell is answered with zero", "[mechanics]") {
  BandCholesky f({1, 1, 2});
  for (std::size_t i = 0; i < 18; ++i) f.at(i, i) = 2;
  f.at(3, 3) = f.at(8, 8) = f.at(3, 8) = 1;  // two rows that say the same
  f.at(14, 14) = 0;
  f.factor();
  std::vector<float> x(18, 4);
  f.solve(x.data());
  for (std::size_t i = 0; i < 18; ++i) CHECK(x[i] == Approx(i == 3 ? 4.0f : i == 8 || i == 14 ? 0.0f : 2.0f));
}
