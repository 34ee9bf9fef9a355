// Disjoint sets against a brute-force relabelling.
#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>

#include "base/random.h"
#include "base/union_find.h"
#include "cases.h"

using namespace geo;

TEST_CASE("sets are represented by their lowest elements, whatever the order of unions", "[union-find]") {
  const auto [first, count] = seeds(50);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const std::uint32_t n = 1 + random.below(60);
    UnionFind sets(n);
    std::vector<std::uint32_t> lowest(n);
    std::iota(lowest.begin(), lowest.end(), 0u);
    for (std::uint32_t step = 0; step < n; ++step) {
      const auto a = random.below(n), b = random.below(n);
      sets.unite(a, b);
      const auto low = std::min(lowest[a], lowest[b]), high = std::max(lowest[a], lowest[b]);
      std::replace(lowest.begin(), lowest.end(), high, low);
      for (std::uint32_t i = 0; i < n; ++i) REQUIRE(sets.find_shared(i) == lowest[i]);
      const auto i = random.below(n);
      REQUIRE(sets.find(i) == lowest[i]);  // shortens paths, and changes no set
    }
    for (std::uint32_t i = 0; i < n; ++i) REQUIRE(sets.find(i) == lowest[i]);
  }
}
