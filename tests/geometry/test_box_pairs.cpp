// Pairs of few and of many boxes against a double loop.
#include <algorithm>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "geometry/box_pairs.h"

using namespace geo;

TEST_CASE("the pairs of few and of many boxes are those of a double loop, filtered") {
  const auto [first, cases] = seeds(20);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(cases); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const std::uint32_t count = seed % 2 == 0 ? static_cast<std::uint32_t>(random.below(200)) : 1200;
    std::vector<Box3> boxes;
    for (std::uint32_t i = 0; i < count; ++i) {
      // A third of the corners is on a grid, so that boxes touch.
      Vec3 p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      if (random.below(3) == 0) p = (8 * p).array().round() / 8;
      boxes.push_back({p, p + Vec3(0.125, random.uniform(0, 0.3), random.below(2) == 0 ? 0 : 0.125)});
    }
    const auto wanted = [](std::uint32_t i, std::uint32_t j) { return (i + j) % 3 != 0; };
    AabbTree::Pairs expected;
    for (std::uint32_t i = 0; i < count; ++i)
      for (std::uint32_t j = i + 1; j < count; ++j)
        if (boxes[i].meets(boxes[j]) && wanted(i, j)) expected.push_back({i, j});
    auto pairs = meeting_pairs(boxes, [&](AabbTree::Pairs& some) {
      std::erase_if(some, [&](const auto& pair) { return !wanted(pair.first, pair.second); });
    });
    std::sort(pairs.begin(), pairs.end());
    CHECK(pairs == expected);
  }
}
