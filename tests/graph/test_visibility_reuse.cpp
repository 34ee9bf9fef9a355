// Visibility reused from an old row, against a search for each entry.
#include <algorithm>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "graph/visibility_reuse.h"
#include "kerf/graph.h"
#include "simd_targets.h"

using namespace geo;

namespace {

struct Row {
  std::vector<std::uint32_t> to;
  std::vector<std::uint16_t> bits;
  AdjacencyRow view() const { return {to, bits, {}}; }
};

// Ids below `most`, each with a chance; bits with edges and paths.
Row random_row(Random& random, std::uint32_t most, double chance) {
  Row row;
  for (std::uint32_t i = 0; i < most; ++i) {
    if (random.uniform() >= chance) continue;
    row.to.push_back(i);
    row.bits.push_back(static_cast<std::uint16_t>((random.below(3) ? 0 : AdjacencyRow::edge_bit) |
                                                  (random.below(6) ? 0 : AdjacencyRow::path_bit) |
                                                  random.below(1 << 10)));
  }
  return row;
}

std::vector<std::uint32_t> looked_up(const Row& now, const Row& old, const std::vector<std::uint32_t>& lost) {
  std::vector<std::uint32_t> unsure;
  for (std::uint32_t e = 0; e < now.to.size(); ++e) {
    if (AdjacencyRow::is_edge(now.bits[e])) continue;
    const auto at = std::find(old.to.begin(), old.to.end(), now.to[e]);
    const bool saw = at != old.to.end() && !(old.bits[std::size_t(at - old.to.begin())] & AdjacencyRow::path_bit);
    const bool is_lost = std::find(lost.begin(), lost.end(), now.to[e]) != lost.end();
    if (!saw || is_lost) unsure.push_back(e | (saw && is_lost ? hidden_bit : 0));
  }
  return unsure;
}

}  // namespace

TEST_CASE("What was seen and is still is told from rows of any kind, whatever the vectors") {
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    // Mostly what is left of the old row, sometimes with others between them or behind.
    const Row old = random_row(random, 10 + random.below(150), random.uniform(0.1, 1.0));
    Row now = random_row(random, 10 + random.below(180), random.uniform(0.0, 1.0));
    if (random.below(3)) {
      const double stays = random.uniform();
      const auto news = now;
      now = {};
      for (const auto i : old.to)
        if (random.uniform() < stays) {
          now.to.push_back(i);
          now.bits.push_back(random.below(2) ? AdjacencyRow::edge_bit : 0);
        }
      for (const auto i : news.to)
        if (random.below(20) == 0 && !std::binary_search(now.to.begin(), now.to.end(), i)) {
          const auto at = std::lower_bound(now.to.begin(), now.to.end(), i) - now.to.begin();
          now.to.insert(now.to.begin() + at, i);
          now.bits.insert(now.bits.begin() + at, 0);
        }
    }
    std::vector<std::uint32_t> lost;
    for (const auto i : old.to)
      if (random.below(5) == 0) lost.push_back(i);
    const auto expected = looked_up(now, old, lost);
    for_each_simd_target([&] {
      std::vector<std::uint32_t> unsure(now.to.size());
      unsure.resize(entries_to_retest(now.to, now.bits, old.view(), lost, unsure.data()));
      CHECK(unsure == expected);
    });
  }
}
