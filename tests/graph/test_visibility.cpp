#include <catch2/catch.hpp>

#include "cases.h"
#include "clouds.h"
#include "geometry/predicates.h"
#include "graph/visibility.h"
#include "kerf/parallel.h"
#include "simd_targets.h"

using namespace geo;

namespace {

using Soup = std::vector<std::array<Vec3, 3>>;
using Pairs = std::vector<std::pair<NodeId, NodeId>>;

std::vector<std::uint8_t> by_all_triangles(const std::vector<Vec3>& x, const Soup& soup, const Pairs& pairs) {
  std::vector<std::uint8_t> result;
  for (const auto& [i, j] : pairs)
    result.push_back(std::any_of(soup.begin(), soup.end(), [&, a = i.index(), b = j.index()](const auto& t) {
      return segment_meets_triangle(x[a], x[b], t[0], t[1], t[2]);
    }));
  return result;
}

Pairs some_pairs(Random& random, std::size_t nodes, int count) {
  Pairs pairs;
  while (pairs.size() < static_cast<std::size_t>(count)) {
    const NodeId i(random.below(static_cast<std::uint32_t>(nodes)));
    for (auto q = random.below(70); q-- > 0;)
      pairs.push_back({i, NodeId(random.below(static_cast<std::uint32_t>(nodes)))});
  }
  return pairs;
}

}  // namespace

TEST_CASE("segments are blocked where exact predicates on all triangles say so, on every kind of vectors") {
  const auto [first, count] = seeds(120);
  std::size_t blocked = 0, open = 0;
  for (auto seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    Random random(seed);
    CAPTURE(seed);
    // Half of them on a lattice of few points: segments through edges and corners, in planes, along
    // edges, of no length; triangles without area. The others at random, near or far, large or
    // small; some nodes are far outside.
    const bool lattice = seed % 2 == 0;
    const double size = std::pow(10, random.uniform(-40, 40)), away = seed % 3 == 0 ? 1e6 : 0;
    const double most = seed % 4 == 1 ? 0.3 : 1;
    const auto any = [&]() -> Vec3 {
      if (lattice) return Vec3(random.below(4), random.below(4), random.below(4));
      return size * (Vec3(random.uniform(), random.uniform(), random.uniform()) + Vec3::Constant(away));
    };
    Soup soup(random.below(random.below(2) ? 20 : 700));
    for (auto& t : soup) {
      const Vec3 at = any();
      for (auto& corner : t) corner = lattice ? any() : Vec3(at + most * random.uniform() * 0.3 * (any() - at));
    }
    std::vector<Vec3> x;
    for (int i = 0; i < 60; ++i) {
      x.push_back(any());
      if (!soup.empty() && i % 5 == 0)
        x.back() = soup[random.below(static_cast<std::uint32_t>(soup.size()))][random.below(3)];
      if (!lattice && i % 7 == 0) x.back() *= std::pow(10, random.uniform(-1, 12));
    }
    const auto pairs = some_pairs(random, x.size(), 300);
    const auto expected = by_all_triangles(x, soup, pairs);
    const TriangleBvh tree(soup);
    const Visibility sight(x, tree);
    for_each_simd_target([&] { REQUIRE(sight.blocked(pairs) == expected); });
    for (std::size_t e = 0; e < 40; ++e) REQUIRE(sight.blocked(pairs[e].first, pairs[e].second) == (expected[e] != 0));
    for (const auto b : expected) ++(b ? blocked : open);
  }
  CHECK(blocked > 5000);
  CHECK(open > 5000);
}

TEST_CASE("visibility is the same for any number of threads") {
  Random random(5);
  Soup soup(3000);
  for (auto& t : soup) {
    const Vec3 at(random.uniform(), random.uniform(), random.uniform());
    for (auto& corner : t) corner = at + 0.05 * random.direction();
  }
  const auto x = cloud(random, 0, 3000);
  const auto pairs = some_pairs(random, x.size(), 20000);
  const TriangleBvh tree(soup);
  const Visibility sight(x, tree);
  set_threads(1);
  const auto expected = sight.blocked(pairs);
  for (const int threads : {2, 4}) {
    set_threads(threads);
    CHECK(sight.blocked(pairs) == expected);
  }
  set_threads(0);
  CHECK(std::count(expected.begin(), expected.end(), 1) > 1000);
}
