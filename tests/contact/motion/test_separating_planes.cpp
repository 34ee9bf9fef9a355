// Vertices that move between separating planes cross nothing, whatever they want.
#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>

#include "base/random.h"
#include "cases.h"
#include "contact/detection/find_crossings.h"
#include "contact/motion/separating_planes.h"

using namespace geo;

TEST_CASE("moves between planes cross nothing at any time and stay within their limits", "[planes]") {
  const auto [first, count] = seeds(20);
  std::size_t wanted_crossings = 0;
  double moved = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    // An uneven sheet, as neighbours, and triangles above it.
    constexpr std::uint32_t n = 4;
    std::vector<Vec3> at;
    std::vector<Triangle> triangles;
    for (std::uint32_t i = 0; i <= n; ++i)
      for (std::uint32_t j = 0; j <= n; ++j) at.push_back(Vec3(i, j, 0.1 * random.uniform()));
    const auto grid = [](std::uint32_t i, std::uint32_t j) { return i * (n + 1) + j; };
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t j = 0; j < n; ++j) {
        triangles.push_back({grid(i, j), grid(i + 1, j), grid(i, j + 1)});
        triangles.push_back({grid(i + 1, j), grid(i + 1, j + 1), grid(i, j + 1)});
      }
    for (int k = 0; k < 10; ++k) {
      const auto base = static_cast<std::uint32_t>(at.size());
      const Vec3 center(random.uniform(0, n), random.uniform(0, n), 0.3 + 0.3 * k);
      for (int c = 0; c < 3; ++c)
        at.push_back(center + Vec3(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 0.1 * random.uniform()));
      triangles.push_back({base, base + 1, base + 2});
    }
    std::vector<std::uint32_t> itself(at.size());
    std::iota(itself.begin(), itself.end(), 0u);
    REQUIRE(find_crossings(triangles, at, itself, false).empty());
    std::vector<TrianglePair> pairs;
    for (std::uint32_t s = 0; s < triangles.size(); ++s)
      for (std::uint32_t t = s + 1; t < triangles.size(); ++t) pairs.push_back({s, t});
    std::vector<Vec3> to;
    std::vector<double> limit;
    for (const Vec3& p : at) {
      to.push_back(p + random.uniform() * random.direction());
      limit.push_back(random.below(5) == 0 ? 0 : random.uniform());
    }
    wanted_crossings += find_crossings(triangles, to, itself, false).size();
    const std::vector<Vec3> start = at;
    const std::size_t planes = move_between_planes({triangles, pairs, to, limit, 1e-3}, at);
    REQUIRE(planes > 0);
    for (std::size_t v = 0; v < at.size(); ++v) {
      REQUIRE((at[v] - start[v]).norm() <= limit[v] + 1e-12);
      moved += (at[v] - start[v]).norm();
    }
    // Each vertex stays on its side of its planes, so it may stop anywhere on its path.
    for (int sample = 0; sample < 10; ++sample) {
      std::vector<Vec3> stopped = at;
      for (std::size_t v = 0; v < at.size(); ++v) stopped[v] = start[v] + random.uniform() * (at[v] - start[v]);
      REQUIRE(find_crossings(triangles, stopped, itself, false).empty());
    }
    REQUIRE(find_crossings(triangles, at, itself, false).empty());
  }
  if (count >= 20) {
    CHECK(wanted_crossings > 20);
    CHECK(moved > 100);
  }
}

TEST_CASE("a vertex far from everything reaches its target", "[planes]") {
  const std::vector<Triangle> triangles{{0, 1, 2}, {3, 4, 5}};
  std::vector<Vec3> at{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}, {10, 9, 9}, {9, 10, 9}};
  std::vector<Vec3> to = at;
  to[0] = {0.1, 0.2, 0.3};
  const std::vector<double> limit(6, 1);
  CHECK(move_between_planes({triangles, std::vector<TrianglePair>{{0, 1}}, to, limit, 1e-3}, at) == 0);
  CHECK(at == to);
}
