// Queries of the bounding volume hierarchy against scans of all triangles.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.h"
#include "cases.h"
#include "geometry/bvh.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"

using namespace geo;

namespace {

std::vector<std::array<Vec3, 3>> soup(Random& random, std::size_t count) {
  std::vector<std::array<Vec3, 3>> triangles;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 at = random.uniform(0, 2) * random.direction();
    triangles.push_back({at, Vec3(at + 0.3 * random.direction()), Vec3(at + 0.3 * random.direction())});
  }
  return triangles;
}

// The twelve triangles of the cube [0, 1]³, counter-clockwise from outside.
std::vector<std::array<Vec3, 3>> cube() {
  std::vector<std::array<Vec3, 3>> triangles;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1}) {
      const Vec3 o = side * Vec3::Unit(axis), u = Vec3::Unit((axis + 1) % 3), v = Vec3::Unit((axis + 2) % 3);
      for (auto t : {std::array<Vec3, 3>{o, o + u, o + u + v}, std::array<Vec3, 3>{o, o + u + v, o + v}}) {
        if (side == 0) std::swap(t[1], t[2]);
        triangles.push_back(t);
      }
    }
  return triangles;
}

}  // namespace

TEST_CASE("packets of segments are blocked as each segment alone", "[bvh]") {
  const auto [first, count] = seeds(6);
  std::size_t blocked = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const auto triangles = soup(random, 1 + random.below(400));
    const TriangleBvh tree(triangles);
    REQUIRE(tree.size() == triangles.size());
    for (int query = 0; query < 10; ++query) {
      const Vec3 p = random.uniform(0, 2) * random.direction();
      std::vector<Vec3> ends(random.below(80));
      for (Vec3& q : ends) q = p + random.uniform(0, query % 2 == 0 ? 0.3 : 3) * random.direction();
      if (!ends.empty()) ends[0] = triangles[0][0];  // touches a corner
      std::vector<std::uint8_t> result(ends.size() + 1, 7);
      tree.blocks(p, ends, result.data());
      for (std::size_t i = 0; i < ends.size(); ++i) {
        const bool expected = std::any_of(triangles.begin(), triangles.end(), [&](const auto& t) {
          return segment_meets_triangle(p, ends[i], t[0], t[1], t[2]);
        });
        REQUIRE(result[i] == expected);
        REQUIRE(tree.blocks(p, ends[i]) == expected);
        blocked += expected;
      }
      REQUIRE(result.back() == 7);  // nothing is written beyond the end
    }
  }
  if (count >= 6) CHECK(blocked > 50);
}

TEST_CASE("closest triangles and triangles near a box are those of a scan", "[bvh]") {
  const auto [first, count] = seeds(6);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    auto triangles = soup(random, 1 + random.below(2000));
    triangles.push_back(triangles[0]);  // of equally near triangles the first counts
    const TriangleBvh tree(triangles);
    for (int query = 0; query < 20; ++query) {
      const Vec3 p = random.uniform(0, 3) * random.direction();
      std::uint32_t nearest = 0;
      double distance = 1e300;
      for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        const auto& [a, b, c] = triangles[t];
        const double d = (closest_point_on_triangle(p, a, b, c) - p).squaredNorm();
        if (d < distance) {
          distance = d;
          nearest = t;
        }
      }
      const auto found = tree.closest(p);
      REQUIRE(found.triangle == nearest);
      REQUIRE(found.distance == std::sqrt(distance));
      REQUIRE((found.point - p).norm() == Approx(found.distance));
      REQUIRE(tree.closest(p, 0.9 * found.distance).triangle == ~0u);
      const Box3 box = Box3{p, p}.grown(random.uniform(0, 1));
      std::vector<std::uint32_t> near, expected;
      tree.near(box, near);
      std::sort(near.begin(), near.end());
      for (std::uint32_t t = 0; t < triangles.size(); ++t)
        if (box_of(triangles[t][0], triangles[t][1], triangles[t][2]).meets(box)) expected.push_back(t);
      REQUIRE(near == expected);
    }
  }
}

TEST_CASE("points are inside a cube strictly, also on diagonals and grid lines", "[bvh]") {
  const TriangleBvh tree(cube());
  for (int i = -2; i <= 10; ++i)
    for (int j = -2; j <= 10; ++j)
      for (int k = -2; k <= 10; ++k) {
        const Vec3 p = Vec3(i, j, k) / 8;
        const bool expected = p.minCoeff() > 0 && p.maxCoeff() < 1;
        REQUIRE(tree.inside(p) == expected);
      }
  CHECK(tree.inside({0.5, 0.5, std::nextafter(1.0, 0.0)}));
  CHECK_FALSE(tree.inside({0.5, 0.5, 1.0}));
}

TEST_CASE("an empty tree blocks and contains nothing", "[bvh]") {
  const TriangleBvh tree;
  CHECK(tree.empty());
  CHECK_FALSE(tree.blocks({0, 0, 0}, {1, 1, 1}));
  CHECK_FALSE(tree.inside({0, 0, 0}));
  CHECK(tree.closest({0, 0, 0}).triangle == ~0u);
}
