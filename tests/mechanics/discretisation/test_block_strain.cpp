// Gradients and forces in single precision against those in double.
#include "mechanics/discretisation/block_strain.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "kerf/solid.h"
#include "mechanics/bodies.h"
#include "mechanics/discretisation/elastic_block.h"
#include "mechanics/solver/solid_discretisation.h"
#include "simd_targets.h"

using namespace geo;

namespace {

Material steel() {
  Material m;
  m.young = 2e11;
  m.density = 7800;
  m.damping = 0;
  return m;
}

std::vector<Vec3> field(const Body& body, const std::function<Vec3(const Vec3&)>& u) {
  std::vector<Vec3> values;
  for (const Vec3& x : body.nodes.position) values.push_back(u(x));
  return values;
}

struct Affine {
  Mat3 gradient;
  Vec3 shift;
  Vec3 operator()(const Vec3& x) const { return gradient * x + shift; }
};
// Turned by any angle, far away, and stretched by a tenth.
Affine any_affine(Random& random) {
  const Mat3 turned = Eigen::AngleAxisd(random.uniform(0, 3.1), random.direction()).toRotationMatrix(),
             stretch = Mat3::NullaryExpr([&] { return random.uniform(-0.1, 0.1); });
  return {turned * (Mat3::Identity() + stretch) - Mat3::Identity(), 1e3 * random.direction()};
}

// A smooth field with gradients of this size.
std::function<Vec3(const Vec3&)> any_waves(Random& random, double size) {
  const Vec3 along = 3 * random.direction(), way = random.direction();
  return [=](const Vec3& x) -> Vec3 { return size / 3 * std::sin(along.dot(x)) * way; };
}

Mat3 matrix(const PointMatrices<double>& columns, std::size_t point) {
  Mat3 m;
  for (int c = 0; c < 3; ++c) m.col(c) = Eigen::Map<const Vec3>(&columns.column[c][4 * point]);
  return m;
}

// The largest difference of gradients at any point.
double largest_difference(const MaterialPoints& points, const BlockStrain& one, const BlockStrain& other,
                          const std::vector<Vec3>& u) {
  BlockStrain::Scratch scratch;
  PointMatrices<double> a, b;
  double largest = 0;
  for (std::size_t block = 0; block < points.blocks.size(); ++block) {
    one.gradients(block, u, scratch, a);
    other.gradients(block, u, scratch, b);
    for (std::size_t i = 0; i < points.blocks[block].points.size(); ++i)
      largest = std::max(largest, (matrix(a, i) - matrix(b, i)).norm());
  }
  return largest;
}

}  // namespace

TEST_CASE(
    "after an affine motion single precision adds no strain, and strains relative to it have errors of ten-thousandths "
    "of themselves",
    "[mechanics]") {
  const Body body = block_body({1, 0.7, 0.6}, 0.11);
  Solid solid(body, steel());
  const MaterialPoints& points = SolidDiscretisation::of(solid).points;
  const std::vector<std::uint32_t> whole(body.nodes.size(), 0);
  const BlockStrain exact(points);
  const auto [first_seed, count] = seeds(60);
  for (int k = 0; k < count; ++k) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(k);
    CAPTURE(seed);
    Random random(seed);
    const Affine affine = any_affine(random);
    const double size = std::pow(10.0, random.uniform(-8, -0.5));
    const auto waves = any_waves(random, size);
    const auto moved = field(body, affine),
               bent = field(body, [&](const Vec3&x) -> Vec3 { return affine(x) + waves(x); });
    for_each_simd_target([&] {
      const BlockStrain loose(points, body.nodes.position, whole, moved);
      CHECK(largest_difference(points, exact, loose, moved) < 1e-11);  // of a shift of 1e3, in places 1e-13 of that
      CHECK(largest_difference(points, exact, loose, bent) < 2e-4 * size + 1e-11);
    });
  }
}

TEST_CASE("forces in single precision are derivatives of the energies in single precision", "[mechanics]") {
  const Body body = block_body({1, 0.7, 0.6}, 0.11);
  Solid solid(body, steel());
  const MaterialPoints& points = SolidDiscretisation::of(solid).points;
  const std::vector<std::uint32_t> whole(body.nodes.size(), 0);
  const auto [first_seed, count] = seeds(30);
  for (int k = 0; k < count; ++k) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(k);
    CAPTURE(seed);
    Random random(seed);
    const Affine affine = any_affine(random);
    const auto waves = any_waves(random, 0.1), way = any_waves(random, 0.1);
    const BlockStrain loose(points, body.nodes.position, whole, field(body, affine));
    ElasticBlock::Scratch scratch;
    ElasticBlock block(scratch, loose, Materials(steel()));
    // Two places on either side, and the force between.
    const auto at = [&](double t) {
      return field(body, [&](const Vec3& x) -> Vec3 { return affine(x) + waves(x) + t * way(x); });
    };
    constexpr double step = 1e-3;
    const auto before = at(-step), here = at(0), after = at(step), direction = field(body, way);
    double less = 0, more = 0, work = 0, size = 0;
    for (std::size_t b = 0; b < points.blocks.size(); ++b) {
      std::vector<double> pull(4 * points.blocks[b].nodes.size());
      for (const double e : block.evaluate(b, before, {}, nullptr, nullptr)) less += e;
      for (const double e : block.evaluate(b, after, {}, nullptr, nullptr)) more += e;
      block.evaluate(b, here, {}, nullptr, pull.data());
      for (std::size_t j = 0; j < points.blocks[b].nodes.size(); ++j) {
        const Vec3 own = Eigen::Map<const Vec3>(&pull[4 * j]);
        work += own.dot(direction[points.blocks[b].nodes[j]]);
        size += own.norm() * direction[points.blocks[b].nodes[j]].norm();
      }
    }
    CHECK(std::abs((more - less) / (2 * step) - work) < 1e-5 * size);
  }
}

TEST_CASE("blocks with several components, or with points of poor quality, stay in double precision", "[mechanics]") {
  const Body body = block_body({1, 0.7, 0.6}, 0.11);
  Solid solid(body, steel());
  MaterialPoints points = SolidDiscretisation::of(solid).points;
  std::vector<std::uint32_t> halves;
  for (const Vec3& x : body.nodes.position) halves.push_back(x.x() > 0.5);
  Random random(3);
  const auto u = field(body, any_waves(random, 0.3));
  const BlockStrain exact(points), of_halves(points, body.nodes.position, halves, u);
  BlockStrain::Scratch scratch;
  PointMatrices<double> a, b;
  std::size_t mixed = 0;
  for (std::size_t block = 0; block < points.blocks.size(); ++block) {
    const auto& nodes = points.blocks[block].nodes;
    if (std::all_of(nodes.begin(), nodes.end(), [&](auto j) { return halves[j] == halves[nodes[0]]; })) continue;
    exact.gradients(block, u, scratch, a);
    of_halves.gradients(block, u, scratch, b);
    ++mixed;
    for (std::size_t i = 0; i < points.blocks[block].points.size(); ++i) CHECK(matrix(a, i) == matrix(b, i));
  }
  CHECK(mixed > 0);
  for (PointBlock& block : points.blocks) block.points[0].quality = MomentQuality::poor;
  CHECK(largest_difference(
            points, BlockStrain(points),
            BlockStrain(points, body.nodes.position, std::vector<std::uint32_t>(body.nodes.size(), 0), u), u) == 0);
}

TEST_CASE("a stiff bar that has turned stays at rest at any accuracy", "[mechanics]") {
  const Body body = block_body({2, 0.4, 0.4}, 0.1);
  const std::size_t n = body.nodes.size();
  const Mat3 turned = Eigen::AngleAxisd(1.5707963, Vec3(0.2, 1, 0.1).normalized()).toRotationMatrix();
  const auto there = field(body, [&](const Vec3& x) -> Vec3 { return turned * x - x; });
  for (const double poisson : {0.3, 0.49, 0.4999})
    for (const double accuracy : {0.005, 0.02}) {
      Material m = steel();
      m.poisson = poisson;
      Solid solid(body, m);
      State state{there, std::vector<Vec3>(n, Vec3::Zero())};
      Environment env;
      env.gravity.setZero();
      for (int k = 0; k < 12; ++k) solid.step_implicit(state, 0.04, env, accuracy);
      double largest = 0;
      for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, (state.displacement[i] - there[i]).norm());
      INFO("Poisson's ratio " << poisson << ", accuracy " << accuracy);
      CHECK(largest < 1e-6 * 0.1);
    }
}
