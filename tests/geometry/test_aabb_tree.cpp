// Pairs of boxes against a double loop, for new trees, refitted trees and enlarged boxes.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.h"
#include "cases.h"
#include "geometry/aabb_tree.h"
#include "kerf/parallel.h"
#include "simd_targets.h"

using namespace geo;

TEST_CASE("the pairs of a tree are those of a double loop") {
  const auto [first, cases] = seeds(60);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(cases); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    std::vector<Box3> boxes;
    // A tree over some hundreds of boxes has three levels.
    const std::uint32_t count = random.below(4) == 0 ? 10 + static_cast<std::uint32_t>(random.below(1000)) : 150;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3 p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      const double size = random.below(10) == 0 ? random.uniform(0, 1) : random.uniform(0, 0.1);
      boxes.push_back(random.below(20) == 0
                          ? Box3()
                          : Box3{p, p + size * Vec3(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1))});
      if (random.below(5) == 0 && !boxes.back().empty()) boxes.push_back(boxes.back());
    }
    std::vector<std::uint8_t> some;
    for (std::size_t i = 0; i < boxes.size(); ++i) some.push_back(random.below(4) == 0);
    const auto expected = [&](bool only) {
      std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
      for (std::uint32_t i = 0; i < boxes.size(); ++i)
        for (std::uint32_t j = i + 1; j < boxes.size(); ++j)
          if (!boxes[i].empty() && !boxes[j].empty() && boxes[i].meets(boxes[j]) && (!only || some[i] || some[j]))
            pairs.push_back({i, j});
      return pairs;
    };
    const auto sorted = [](std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs) {
      std::sort(pairs.begin(), pairs.end());
      return pairs;
    };
    CHECK(sorted(overlapping_pairs(boxes)) == expected(false));
    CHECK(sorted(overlapping_pairs(boxes, &some)) == expected(true));
    // Some become larger, also beyond the bounding box of all.
    AabbTree tree(boxes);
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      if (boxes[i].empty() || random.below(10) != 0) continue;
      const Vec3 p(random.uniform(-3, 3), random.uniform(-1, 1), random.uniform(-1, 1));
      tree.enlarge(i, {p, p});
      boxes[i].add(p);
    }
    const auto all = tree.pairs(), with_some = tree.pairs(&some);
    CHECK(sorted(all) == expected(false));
    CHECK(sorted(with_some) == expected(true));
    for (const std::size_t most : {all.size() / 2, all.size(), 2 * all.size() + 1}) {
      CHECK(tree.pairs_up_to(most) == (all.size() <= most ? std::optional(all) : std::nullopt));
      CHECK(tree.pairs_up_to(most, &some) == (with_some.size() <= most ? std::optional(with_some) : std::nullopt));
    }
    for_each_simd_target([&] {
      CHECK(tree.pairs() == all);
      CHECK(tree.pairs(&some) == with_some);
    });
    // All boxes move, some far, or all so far that floats hardly distinguish them. A box that was
    // empty prevents a refit.
    std::vector<Box3> others = boxes;
    const Vec3 all_by =
        random.below(3) == 0 ? Vec3(std::pow(10.0, random.uniform(0, 9)) * random.direction()) : Vec3(Vec3::Zero());
    for (Box3& b : others) {
      const Vec3 by = all_by + random.uniform(0, random.below(10) == 0 ? 4 : 0.1) * random.direction();
      if (!b.empty()) {
        b.lo += by;
        b.hi += by;
      }
    }
    boxes = others;
    REQUIRE(tree.refit(others));
    CHECK(sorted(tree.pairs()) == expected(false));
    CHECK(sorted(tree.pairs(&some)) == expected(true));
    const auto empty = std::find_if(boxes.begin(), boxes.end(), [](const Box3& b) { return b.empty(); });
    if (empty == boxes.end()) continue;
    others = boxes;
    others[static_cast<std::size_t>(empty - boxes.begin())].add(Vec3::Zero());
    CHECK(!tree.refit(others));
    CHECK(sorted(tree.pairs()) == expected(false));
  }
}

TEST_CASE("pairs have the same order for any number of threads, also after a refit") {
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  Random random(5);
  std::vector<Box3> first, then;
  std::vector<std::uint8_t> some;
  for (int i = 0; i < 10000; ++i) {
    const Vec3 p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)),
        by = random.uniform(0, 0.1) * random.direction();
    const Vec3 size = 0.1 * Vec3(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
    const bool none = random.below(50) == 0;
    first.push_back(none ? Box3() : Box3{p, p + size});
    then.push_back(none || random.below(10) == 0 ? Box3() : Box3{p + by, p + by + size});
    some.push_back(random.below(4) == 0);
  }
  const auto same = [](const std::vector<Box3>& a, const std::vector<Box3>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const Box3& p, const Box3& q) { return p.lo == q.lo && p.hi == q.hi; });
  };
  const auto run = [&] {
    AabbTree tree(first);
    std::vector<Pairs> found{tree.pairs(), tree.pairs(&some)};
    // A refused refit changes nothing on either side: a box that was empty, one too few, one too
    // many.
    auto wrong = then;
    wrong[static_cast<std::size_t>(std::find_if(first.begin(), first.end(), [](const Box3& b) { return b.empty(); }) -
                                   first.begin())]
        .add(Vec3::Zero());
    for (const auto& refused :
         {wrong, std::vector<Box3>(then.begin(), then.end() - 1), std::vector<Box3>(then.size() + 1)}) {
      auto given = refused;
      CHECK(!tree.refit(given));
      CHECK(same(given, refused));
      CHECK(same(tree.boxes(), first));
      CHECK(tree.pairs() == found[0]);
    }
    auto given = then;
    REQUIRE(tree.refit(given));
    CHECK(same(tree.boxes(), then));
    found.push_back(tree.pairs());
    found.push_back(tree.pairs(&some));
    return found;
  };
  set_threads(1);
  const auto alone = run();
  set_threads(3);
  CHECK(run() == alone);
  set_threads(0);
  CHECK(alone[0].size() > 5000);
  // A new tree finds the same pairs.
  const AabbTree anew(then);
  for (const bool asked : {false, true}) {
    auto replaced = alone[asked ? 3 : 2], expected = anew.pairs(asked ? &some : nullptr);
    std::sort(replaced.begin(), replaced.end());
    std::sort(expected.begin(), expected.end());
    CHECK(replaced == expected);
  }
}
