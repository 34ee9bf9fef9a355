// Where cracks start: averaged stresses of uniform deformations, and starts in random stress fields
// against a search over all nodes.
#include "simulation/fracture_start.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "geometry/distance.h"
#include "kerf/mesh.h"
#include "simulation/notched_block.h"
#include "simulation/strength.h"

using namespace geo;

namespace {

Mat3 random_matrix(Random& random, double size) {
  Mat3 m;
  for (int i = 0; i < 9; ++i) m(i) = random.uniform(-size, size);
  return m;
}

double distance_from_cracks(const Complex& k, const Vec3& x) {
  double least = 1e300;
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    if (k.alive(FaceId(f)) && k.face(FaceId(f)).crack != 0) {
      const auto c = k.corners(FaceId(f));
      least = std::min(least, (closest_point_on_triangle(x, c[0], c[1], c[2]) - x).norm());
    }
  return least;
}

}  // namespace

TEST_CASE("a uniform deformation has its stress at every node, in material axes however the body has turned") {
  const auto [first, count] = seeds(10);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Notched block = notched_block({1, 0.6, 0.3}, 0.12, random.uniform(0.2, 0.5), 0.31, seed);
    Material material;
    material.model = random.below(2) == 0 ? ElasticModel::neo_hookean : ElasticModel::saint_venant_kirchhoff;
    material.poisson = random.uniform(0, 0.4);
    const Solid solid(block.body, material);
    // F = R U with a symmetric stretch U.
    const Mat3 noise = random_matrix(random, 0.1), stretch = Mat3::Identity() + 0.5 * (noise + noise.transpose()),
               turn = Eigen::AngleAxisd(random.uniform(0, 3), random.direction()).toRotationMatrix(),
               f = turn * stretch;
    State motion;
    for (const Vec3& x : block.body.nodes.position) motion.displacement.push_back(f * x - x);
    motion.velocity.assign(solid.size(), Vec3::Zero());
    const Mat3 expected = stress(material, stretch) * stretch.transpose() / stretch.determinant();
    const auto found = averaged_stress(block.body, solid, motion);
    REQUIRE(found.size() == solid.size());
    std::size_t without = 0;
    for (const Mat3& s : found) {
      without += s.isZero(0);
      if (!s.isZero(0)) CHECK((s - expected).norm() < 1e-6 * expected.norm());
    }
    CHECK(20 * without < found.size());
  }
}

TEST_CASE("starts are the nodes with most stress over strength that nothing keeps from breaking, one near another") {
  const auto [first, count] = seeds(40);
  std::size_t starts = 0, limited = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Notched block = notched_block({1, 0.6, 0.3}, 0.1, random.uniform(0.2, 0.5), 0.31, 1 + seed % 3);
    const NodeSet& nodes = block.body.nodes;
    FractureOptions fracture;
    fracture.strength = 1;
    fracture.variation = random.below(2) == 0 ? 0 : 0.5;
    fracture.separation = random.uniform(0, 4);
    fracture.seed = seed;
    std::vector<std::uint32_t> body_index(nodes.size(), 0);
    if (random.below(2) == 0) {
      fracture.per_body.assign(2, fracture);
      fracture.per_body[1].strength = 1.5;
      for (auto& b : body_index) b = random.below(2);
    }
    if (random.below(2) == 0) fracture.off.push_back({Vec3(0.5, -1, -1), Vec3(0.8, 1, 1)});
    std::vector<Mat3> stress;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const Mat3 m = random_matrix(random, 1.5);
      stress.push_back(0.5 * (m + m.transpose()));
    }
    const std::size_t limit = random.below(3) == 0 ? random.below(4) : 1000;
    const auto found = find_starts(block.body, stress, fracture, body_index, limit);
    CHECK(found.size() <= limit);
    starts += found.size();
    limited += found.size() == limit;
    const double diagonal = block.body.surface.extent().diagonal();
    const auto ratio = [&](std::size_t i) {
      const Strength& own = fracture.at_node(body_index, i);
      return Eigen::SelfAdjointEigenSolver<Mat3>(stress[i]).eigenvalues()[2] /
             (own.strength * strength_factor(own, fracture.seed, diagonal, nodes.position[i]));
    };
    const auto reach = [&](std::size_t i) { return fracture.separation * nodes.spacing[i]; };
    for (std::size_t k = 0; k < found.size(); ++k) {
      const CrackStart& s = found[k];
      const std::size_t i = s.node.index();
      CHECK(s.ratio > 1);
      CHECK(s.ratio == Approx(ratio(i)));
      if (k > 0) CHECK(s.ratio <= found[k - 1].ratio);
      CHECK(s.normal.norm() == Approx(1));
      const double principal = s.normal.dot(stress[i] * s.normal);
      CHECK((stress[i] * s.normal - principal * s.normal).norm() < 1e-9);
      CHECK(principal == Approx(Eigen::SelfAdjointEigenSolver<Mat3>(stress[i]).eigenvalues()[2]));
      CHECK(distance_from_cracks(block.body.surface, nodes.position[i]) >= reach(i));
      for (const auto& [lo, hi] : fracture.off)
        CHECK(((nodes.position[i] - lo).array() < 0 || (hi - nodes.position[i]).array() < 0).any());
      for (std::size_t o = 0; o < k; ++o)
        CHECK((nodes.position[found[o].node.index()] - nodes.position[i]).norm() >= reach(i));
    }
    // Every other node is below its strength, in a box, near a crack, near an earlier start, or
    // behind the last one of the limit.
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const double own = ratio(i);
      const Vec3& x = nodes.position[i];
      if (own <= 1 || !may_break(fracture, x) || distance_from_cracks(block.body.surface, x) < reach(i)) continue;
      const bool near_one = std::any_of(found.begin(), found.end(), [&](const CrackStart& s) {
        return s.node.index() == i ||
               (s.ratio >= own * (1 - 1e-12) && (nodes.position[s.node.index()] - x).norm() < reach(i));
      });
      const bool late = found.size() == limit && (limit == 0 || found.back().ratio >= own * (1 - 1e-12));
      CHECK((near_one || late));
    }
  }
  CHECK(starts > 100);
  CHECK(limited > 0);
}
