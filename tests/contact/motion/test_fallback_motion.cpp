#include "contact/motion/fallback_motion.h"

#include <catch2/catch.hpp>
#include <numeric>

#include "base/random.h"
#include "cases.h"

using namespace geo;

TEST_CASE("the fallback moves only what was added, the same for the same motion of all, and rigidly in zones") {
  Random random(1);
  std::vector<Triangle> triangles;
  std::vector<Vec3> start, to;
  for (std::uint32_t t = 0; t < 40; ++t) {
    const Vec3 middle(random.uniform(), random.uniform(), random.uniform());
    for (int c = 0; c < 3; ++c) start.push_back(middle + 0.05 * random.direction());
    triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const Vec3 translation(0.02, -0.01, 0.03);
  for (const Vec3& x : start) to.push_back(x + translation);
  std::vector<std::uint32_t> vertices(start.size());
  std::iota(vertices.begin(), vertices.end(), 0u);
  FallbackMotion fallback(triangles, vertices, start, to, 0.1);
  CHECK(fallback.share() == 1);  // a translation that is short beside a cell is not scaled down
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> pair{{0, 1}};
  REQUIRE(fallback.add(pair));
  std::vector<Vec3> next = start;
  fallback.apply(next);
  for (std::size_t v = 0; v < 6; ++v) CHECK((next[v] - to[v]).norm() < 1e-12);
  for (std::size_t v = 6; v < start.size(); ++v) CHECK(next[v] == start[v]);
  CHECK(fallback.keeps_apart(0, 1, 1e-3));
  CHECK_FALSE(fallback.keeps_apart(0, 2, 1e-3));  // triangle 2 does not follow
  REQUIRE(fallback.add(pair));                    // now as a zone
  REQUIRE_FALSE(fallback.add(pair));
  CHECK(fallback.in_zones() == 6);
  REQUIRE(fallback.add_all());
  REQUIRE_FALSE(fallback.add_all());
}

TEST_CASE("points that follow the fallback's field do not pass each other, however they are thrown together") {
  const auto [first, count] = seeds(20);
  std::size_t scaled = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    std::vector<Triangle> triangles;
    std::vector<Vec3> start, to;
    for (std::uint32_t t = 0; t < 60; ++t) {
      const Vec3 middle(random.uniform(), random.uniform(), random.uniform());
      for (int c = 0; c < 3; ++c) start.push_back(middle + 0.02 * random.direction());
      triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    for (const Vec3& x : start) to.push_back(x + (x.x() < 0.5 ? 1.0 : -1.0) * Vec3(random.uniform(), 0, 0));
    std::vector<std::uint32_t> vertices(start.size());
    std::iota(vertices.begin(), vertices.end(), 0u);
    FallbackMotion fallback(triangles, vertices, start, to, 0.04);
    fallback.add_all();
    std::vector<Vec3> next = start;
    fallback.apply(next);
    scaled += fallback.share() < 1;
    // x + s field(x) with s · slope ≤ 0.6: distances shrink at most to 0.4 of themselves.
    for (std::size_t i = 0; i < start.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Vec3 before = start[i] - start[j], after = next[i] - next[j];
        CHECK(after.dot(before) >= 0.399 * before.squaredNorm());
      }
  }
  REQUIRE(scaled > 0);
}
