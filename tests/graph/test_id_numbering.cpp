// Numbers of ids against a plain map.
#include <catch2/catch.hpp>
#include <map>

#include "base/random.h"
#include "cases.h"
#include "graph/id_numbering.h"

using namespace geo;

TEST_CASE("ids are numbered as they come and listed ascending, guides last") {
  IdNumbering pages;  // one for all cases: each begins with what the one before has left
  for (int seed = 1; seed <= cases(20); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    pages.clear();
    std::map<std::uint32_t, std::uint32_t> expected;
    const auto reach = 1u << (1 + random.below(20));
    for (int k = 0; k < 3000; ++k) {
      const auto id = random.below(reach) + (random.below(5) == 0 ? VisibilityGraph::first_guide : 0);
      const auto number = expected.try_emplace(id, static_cast<std::uint32_t>(expected.size())).first->second;
      REQUIRE(pages.add(id) == number);
    }
    REQUIRE(pages.size() == expected.size());
    auto next = expected.begin();
    pages.each([&](std::uint32_t id, std::uint32_t number) {
      REQUIRE(next != expected.end());
      REQUIRE(id == next->first);
      REQUIRE(number == next->second);
      ++next;
    });
    CHECK(next == expected.end());
  }
}
