// Regions against a disjoint-set oracle on random graphs.
#include <algorithm>
#include <numeric>
#include <vector>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "body/regions.h"
#include "cases.h"

using namespace geo;

TEST_CASE("regions know which elements are connected, and visit little where they are", "[regions]") {
  for (int seed = 1; seed <= cases(30); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const std::uint32_t n = 20 + random.below(200), edges = random.below(n + n / 3);
    std::vector<std::vector<std::uint32_t>> around(n);
    std::vector<std::uint32_t> label(n);
    std::iota(label.begin(), label.end(), 0u);
    for (std::uint32_t e = 0; e < edges; ++e) {
      const auto a = random.below(n), b = random.below(n);
      around[a].push_back(b);
      around[b].push_back(a);
      const auto from = std::max(label[a], label[b]), to = std::min(label[a], label[b]);
      std::replace(label.begin(), label.end(), from, to);
    }
    Regions regions([&](std::uint32_t i, std::vector<std::uint32_t>& out) {
      out.insert(out.end(), around[i].begin(), around[i].end());
    });
    std::vector<std::uint32_t> seeds;
    for (int s = 0; s < 12; ++s) seeds.push_back(random.below(n));
    for (const auto s : seeds) regions.seed(s);
    if (seed % 2) regions.grow_seeds();
    for (const auto a : seeds)
      for (const auto b : seeds) REQUIRE(regions.joined(a, b) == (label[a] == label[b]));
    for (const auto a : seeds) {
      while (!regions.whole(a)) regions.grow(a);
      auto inside = regions.inside(a);
      std::sort(inside.begin(), inside.end());
      std::vector<std::uint32_t> expected;
      for (std::uint32_t i = 0; i < n; ++i)
        if (label[i] == label[a]) expected.push_back(i);
      REQUIRE(inside == expected);
      REQUIRE(regions.lowest(a) == expected.front());
    }
  }
}

TEST_CASE("a query about two adjacent seeds does not visit the rest of a long chain", "[regions]") {
  std::size_t visited = 0;
  Regions regions([&](std::uint32_t i, std::vector<std::uint32_t>& out) {
    ++visited;
    if (i > 0) out.push_back(i - 1);
    if (i < 100000) out.push_back(i + 1);
  });
  regions.seed(500);
  regions.seed(501);
  REQUIRE(regions.joined(500, 501));
  REQUIRE(visited <= 4);
  regions.seed(3);
  regions.seed(100000);
  REQUIRE(regions.joined(3, 500));
  REQUIRE(visited <= 1100);
}
