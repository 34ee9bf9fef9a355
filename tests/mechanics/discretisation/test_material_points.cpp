// Blocks of material points: layout, scatter, and vector kernels against dense matrices.
#include "mechanics/discretisation/material_points.h"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "mechanics/discretisation/kernel.h"
#include "mechanics/discretisation/point_lanes.h"
#include "mechanics/discretisation/stiffness_product_lanes.h"
#include "mechanics/material/stress_derivative.h"
#include "simd_targets.h"

using namespace geo;

namespace {

// A block of random points in a cube, over some of `nodes` nodes; some points have no nodes.
PointBlock random_block(Random& random, std::size_t points, std::uint32_t nodes) {
  std::vector<MaterialPoint> all(points);
  std::vector<ShapeGradients> shapes(points);
  for (std::size_t i = 0; i < points; ++i) {
    all[i].position = Vec3(random.uniform(), random.uniform(), random.uniform());
    all[i].volume = random.uniform(0.5, 1);
    all[i].quality = MomentQuality::good;
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t j = random.below(4); j < nodes && i % 7 != 5; j += 1 + random.below(4)) {
      shapes[i].nodes.push_back(j);
      shapes[i].gradient.push_back(3 * random.uniform() * random.direction());
      sum += shapes[i].gradient.back();
    }
    if (!shapes[i].nodes.empty()) shapes[i].gradient.back() -= sum;  // constants have no gradient
  }
  return {std::move(all), shapes};
}

// ∇ at the points as a dense matrix: row 9 i + 3 c + r, column 3 j + r, over the block's nodes.
Eigen::MatrixXd gradient_matrix(const PointBlock& block) {
  Eigen::MatrixXd b =
      Eigen::MatrixXd::Zero(9 * Eigen::Index(block.points.size()), 3 * Eigen::Index(block.nodes.size()));
  for (std::size_t i = 0; i < block.points.size(); ++i)
    for (auto q = block.entry_begin[i]; q < block.entry_begin[i + 1]; ++q)
      for (Eigen::Index c = 0; c < 3; ++c)
        for (Eigen::Index r = 0; r < 3; ++r)
          b(9 * Eigen::Index(i) + 3 * c + r, 3 * Eigen::Index(block.entry_node[q]) + r) =
              block.entry_gradient[3 * q + std::size_t(c)];
  return b;
}

Eigen::VectorXd random_field(Random& random, const PointBlock& block) {
  return Eigen::VectorXd::NullaryExpr(3 * Eigen::Index(block.nodes.size()), [&] { return random.uniform(-1, 1); });
}

// Four numbers per node.
template <class Number>
std::vector<Number> padded_field(const Eigen::VectorXd& v) {
  std::vector<Number> padded;
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    padded.push_back(Number(v[i]));
    if (i % 3 == 2) padded.push_back(0);
  }
  return padded;
}

template <class Number>
Eigen::VectorXd unpadded(const std::vector<Number>& padded) {
  Eigen::VectorXd v(Eigen::Index(padded.size() / 4 * 3));
  for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = double(padded[std::size_t(i / 3 * 4 + i % 3)]);
  return v;
}

Eigen::VectorXd unpadded(const PointMatrices<double>& m, std::size_t points) {
  Eigen::VectorXd v(9 * Eigen::Index(points));
  for (std::size_t i = 0; i < points; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t r = 0; r < 3; ++r) v[Eigen::Index(9 * i + 3 * c + r)] = m.column[c][4 * i + r];
  return v;
}

PointMatrices<double> matrices_of(const Eigen::VectorXd& v) {
  PointMatrices<double> m;
  m.resize(std::size_t(v.size() / 9));
  for (std::size_t i = 0; i < std::size_t(v.size() / 9); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t r = 0; r < 3; ++r) m.column[c][4 * i + r] = v[Eigen::Index(9 * i + 3 * c + r)];
  return m;
}

}  // namespace

TEST_CASE("gradients and divergence of a block are a dense matrix and its transpose", "[points]") {
  const auto [first, count] = seeds(30);
  for (std::uint64_t seed = first; seed < first + std::uint64_t(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const PointBlock block = random_block(random, 1 + random.below(40), 20);
    const std::size_t points = block.points.size();
    if (block.nodes.empty()) continue;
    const Eigen::MatrixXd b = gradient_matrix(block);
    const Eigen::VectorXd u = random_field(random, block);
    const Eigen::VectorXd s = Eigen::VectorXd::NullaryExpr(b.rows(), [&] { return random.uniform(-1, 1); });
    const double size = b.cwiseAbs().maxCoeff();
    for_each_simd_target([&] {
      PointMatrices<double> gradient;
      point_gradients(block, padded_field<double>(u).data(), gradient);
      CHECK((unpadded(gradient, points) - b * u).norm() < 1e-12 * (1 + b.norm()));
      std::vector<double> force(4 * block.nodes.size(), 0);
      point_divergence(block, matrices_of(s), force.data());
      CHECK((unpadded(force) - b.transpose() * s).norm() < 1e-12 * (1 + b.norm()));
      // The quantised operators, to 16 bits of each point's largest gradient.
      Mat3 affine = Mat3::Zero();
      quantised_gradients(block, padded_field<float>(u).data(), affine, gradient);
      CHECK((unpadded(gradient, points) - b * u).cwiseAbs().maxCoeff() < 20 * 1e-4 * size);
      std::vector<float> single(4 * block.nodes.size(), 0);
      quantised_divergence(block, matrices_of(s), single.data());
      CHECK((unpadded(single) - b.transpose() * s).cwiseAbs().maxCoeff() < double(3 * points) * 1e-4 * size);
      // A constant field has no gradient but the affine one, which points without nodes do not get.
      affine << 1, 2, 3, 4, 5, 6, 7, 8, 9;
      const Eigen::VectorXd ones = Eigen::VectorXd::Ones(u.size());
      quantised_gradients(block, padded_field<float>(ones).data(), affine, gradient);
      const Eigen::VectorXd constant = unpadded(gradient, points);
      for (std::size_t i = 0; i < points; ++i) {
        const Mat3 expected = block.entry_begin[i] < block.entry_begin[i + 1] ? affine : Mat3(Mat3::Zero());
        CHECK((Eigen::Map<const Mat3>(&constant[Eigen::Index(9 * i)]) - expected).norm() < 1e-5 * size);
      }
    });
  }
}

TEST_CASE("stiffness products of a block are those of the dense matrix Bᵀ D B", "[points]") {
  const auto [first, count] = seeds(20);
  for (std::uint64_t seed = first; seed < first + std::uint64_t(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const PointBlock block = random_block(random, 1 + random.below(40), 20);
    if (block.nodes.empty()) continue;
    const std::size_t points = block.points.size(), padded = block.quantum.size();
    Material m;
    m.young = 2;
    m.volume_term = 0.5;
    if (random.below(2)) m.model = ElasticModel::saint_venant_kirchhoff;
    PointMatrices<float> gradient;
    gradient.resize(points);
    std::vector<float> weight(padded, 0);
    Eigen::MatrixXd d = Eigen::MatrixXd::Zero(9 * Eigen::Index(points), 9 * Eigen::Index(points));
    for (std::size_t i = 0; i < points; ++i) {
      weight[i] = float(block.points[i].volume);
      Mat3 f = Mat3::Identity();
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t r = 0; r < 3; ++r) {
          gradient.column[c][4 * i + r] = float(random.uniform(-0.3, 0.3));
          f(Eigen::Index(r), Eigen::Index(c)) += gradient.column[c][4 * i + r];
        }
      d.block<9, 9>(9 * Eigen::Index(i), 9 * Eigen::Index(i)) = double(weight[i]) * projected_derivative(m, f);
    }
    const Eigen::MatrixXd b = gradient_matrix(block), k = b.transpose() * d * b;
    const Eigen::VectorXd v = random_field(random, block);
    for_each_simd_target([&] {
      StiffnessModes modes;
      modes.resize(padded);
      stiffness_modes(stiffness_constants(m), {0, padded}, gradient, nullptr, weight, modes);
      std::vector<float> out(4 * block.nodes.size(), 0);
      multiply_stiffness(block, modes, padded_field<float>(v).data(), out.data());
      CHECK((unpadded(out) - k * v).norm() < 1e-3 * k.norm() * v.norm() / std::sqrt(double(v.size())));
    });
  }
}

TEST_CASE("points add their numbers to nodes by volume and kernel", "[points]") {
  Random random(3);
  const PointBlock block = random_block(random, 13, 9);
  const Vec3 base(0.2, 0.1, 0);
  const double support = 0.9;
  std::vector<float> place, numbers;
  std::vector<Vec3> position;
  for (std::size_t j = 0; j < block.nodes.size(); ++j) {
    position.push_back(Vec3(random.uniform(), random.uniform(), random.uniform()));
    for (int c = 0; c < 3; ++c) place.push_back(float(position[j][c] - base[c]));
    place.push_back(float(1 / (support * support)));
  }
  for (std::size_t i = 0; i < block.points.size(); ++i)
    for (std::size_t k = 0; k < 8; ++k) numbers.push_back(k == 6 ? float(i % 3 != 1) : float(random.uniform(-1, 1)));
  for_each_simd_target([&] {
    std::vector<float> sums(8 * block.nodes.size(), 0);
    add_kernel_weighted(block, base, place.data(), numbers.data(), sums.data());
    std::vector<double> expected(sums.size(), 0);
    for (std::size_t i = 0; i < block.points.size(); ++i)
      for (auto q = block.entry_begin[i]; q < block.entry_begin[i + 1] && i % 3 != 1; ++q) {
        const auto j = block.entry_node[q];
        const double w = kernel((block.points[i].position - position[j]).norm(), support) / kernel(0, support);
        for (std::size_t k = 0; k < 8; ++k)
          expected[8 * j + k] += w * block.points[i].volume * double(numbers[8 * i + k]);
      }
    for (std::size_t k = 0; k < sums.size(); ++k) CHECK(sums[k] == Approx(expected[k]).epsilon(1e-4).margin(1e-5));
  });
}

TEST_CASE("a block made of points of other blocks equals the one made of their shape gradients", "[points]") {
  const auto [first, count] = seeds(30);
  for (std::uint64_t seed = first; seed < first + std::uint64_t(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const PointBlock blocks[] = {random_block(random, 24, 30), random_block(random, 17, 40)};
    std::vector<PointBlock::Source> sources;
    std::vector<MaterialPoint> points;
    std::vector<ShapeGradients> shapes;
    // Whole quads, which are copied, and single points.
    for (int k = 0; k < 6; ++k) {
      const PointBlock& block = blocks[random.below(2)];
      const bool quad = random.below(2);
      const std::size_t from = quad ? 4 * random.below(4) : random.below(16), size = quad ? 4 : 1;
      for (std::size_t i = from; i < from + size; ++i) {
        sources.push_back({&block, i, nullptr});
        points.push_back(block.points[i]);
        shapes.push_back(block.shape_gradients(i));
      }
    }
    CHECK(PointBlock(points, sources) == PointBlock(points, shapes));
  }
}

TEST_CASE("sums at nodes gather the slots of all blocks", "[points]") {
  Random random(6);
  MaterialPoints points;
  for (int b = 0; b < 3; ++b) points.blocks.push_back(random_block(random, 10, 12));
  points.number_points(12);
  CHECK(points.size() == 30);
  CHECK(points.first_point(2) == 20);
  CHECK(points.scatter_offset(0) == 0);
  std::vector<double> slots(2 * points.scatter_size());
  std::vector<std::array<double, 2>> expected(12, {0, 0});
  for (std::size_t b = 0; b < 3; ++b)
    for (std::size_t k = 0; k < points.blocks[b].nodes.size(); ++k)
      for (std::size_t c = 0; c < 2; ++c)
        expected[points.blocks[b].nodes[k]][c] += slots[2 * (points.scatter_offset(b) + k) + c] =
            double(random.below(100));
  for (std::size_t i = 0; i < 12; ++i) CHECK(points.sum_at_node<2>(slots.data(), i) == expected[i]);
}

TEST_CASE("ranges of materials cover a block in eights, and mixed eights have a range for each material", "[points]") {
  std::vector<MaterialPoint> all(20);
  std::vector<ShapeGradients> shapes(20);
  for (std::uint32_t i = 0; i < 20; ++i) shapes[i] = {{i < 12 ? 0u : 1u}, {Vec3::Zero()}};
  shapes[19] = {};  // sees nothing
  PointBlock block(all, shapes);
  Material other;
  other.young = 2;
  block.set_materials(Materials({Material{}, other}, {0, 1}));
  REQUIRE(block.material_ranges.size() == 4);
  const auto& r = block.material_ranges;
  CHECK((r[0].begin == 0 && r[0].end == 8 && r[0].material == 0 && r[0].uniform));
  CHECK((r[1].begin == 8 && r[1].end == 16 && r[1].material == 0 && !r[1].uniform));
  CHECK((r[2].begin == 8 && r[2].end == 16 && r[2].material == 1 && !r[2].uniform));
  CHECK((r[3].begin == 16 && r[3].end == 24 && r[3].material == 1 && r[3].uniform));
  CHECK(block.belongs_to(r[1], 8));
  CHECK_FALSE(block.belongs_to(r[1], 12));
  CHECK(block.belongs_to(r[0], 19));
  CHECK(block.belongs_to(r[0], 23));
  block.set_materials(Material{});
  REQUIRE(block.material_ranges.size() == 1);
  CHECK((block.material_ranges[0].end == 24 && block.material_ranges[0].uniform));
}
