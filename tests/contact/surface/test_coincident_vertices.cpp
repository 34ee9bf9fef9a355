// Representatives and groups of coincident vertices.
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "contact/detection/find_crossings.h"
#include "contact/surface/coincident_vertices.h"

using namespace geo;

TEST_CASE("vertices coincide if site and position are equal, to the bit", "[coincident]") {
  const auto [first, count] = seeds(30);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const std::uint32_t n = 1 + random.below(60);
    std::vector<std::uint32_t> site;
    std::vector<Vec3> positions;
    for (std::uint32_t v = 0; v < n; ++v) {
      site.push_back(random.below(12) * 100);  // sparse, as sites of dead vertices are
      positions.push_back(Vec3(random.below(2), 0, random.below(4) == 0 ? 1e-300 : 0));
    }
    const auto representative = coincident_representatives(site, positions);
    std::vector<std::vector<std::uint32_t>> groups(n);
    for (std::uint32_t v = 0; v < n; ++v) {
      std::uint32_t lowest = 0;
      while (site[lowest] != site[v] || positions[lowest] != positions[v]) ++lowest;
      REQUIRE(representative[v] == lowest);
      groups[lowest].push_back(v);
    }
    const CoincidentVertices coincident(representative);
    REQUIRE(coincident.size() == n);
    for (std::uint32_t v = 0; v < n; ++v)
      REQUIRE(std::vector<std::uint32_t>(coincident[v].begin(), coincident[v].end()) == groups[v]);
  }
}

TEST_CASE("without sites all vertices are distinct", "[coincident]") {
  const std::vector<Vec3> positions(5, Vec3::Zero());
  CHECK(coincident_representatives({}, positions) == std::vector<std::uint32_t>{0, 1, 2, 3, 4});
  const auto distinct = CoincidentVertices::all_distinct(5);
  REQUIRE(distinct.size() == 5);
  for (std::uint32_t v = 0; v < 5; ++v) CHECK((distinct[v].size() == 1 && distinct[v][0] == v));
}
