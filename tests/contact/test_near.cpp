// What spares contact most pairs: lists of near pairs that are kept, and fans that open out.
#include <catch2/catch.hpp>

#include <cmath>
#include <set>

#include "base/random.h"
#include "cases.h"
#include "contact/crossing.h"
#include "contact/near_pairs.h"
#include "contact/vertex_fans.h"

using namespace geo;

TEST_CASE("pairs that are kept from call to call have all whose boxes meet, each once", "[campaign]") {
  const auto [first, count] = seeds(30);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    std::vector<Box3> boxes(40 + random.below(200));
    for (Box3& b : boxes) {
      b.add(Vec3(random.uniform(0, 3), random.uniform(0, 3), random.uniform(0, 3)));
      b = b.grown(random.uniform(0, 0.3));
    }
    NearPairs near;
    std::vector<std::uint8_t> changed(boxes.size(), 1);
    for (int call = 0; call < 8; ++call) {
      const bool told = call > 0 && random.below(2) == 0;
      near.cover(boxes.size(), [&](std::size_t t) { return boxes[t]; }, random.uniform(0, 0.1), told ? &changed : nullptr);
      const std::set<NearPairs::Pair> pairs(near.pairs().begin(), near.pairs().end());
      CHECK(pairs.size() == near.pairs().size());
      std::size_t missing = 0;
      for (std::uint32_t i = 0; i < boxes.size(); ++i)
        for (std::uint32_t j = i + 1; j < boxes.size(); ++j) missing += boxes[i].meets(boxes[j]) && !pairs.contains({i, j});
      CHECK(missing == 0);
      // Few or many go elsewhere.
      const double share = random.below(3) == 0 ? 0.5 : 0.03;
      for (std::size_t t = 0; t < boxes.size(); ++t) {
        changed[t] = random.uniform(0, 1) < share;
        const Vec3 way = 0.4 * random.direction();
        if (changed[t]) boxes[t].lo += way, boxes[t].hi += way;
      }
    }
  }
}

TEST_CASE("no two triangles of a fan that opens out cross, but those of one that goes round twice do", "[campaign]") {
  const auto [first, count] = seeds(3000);
  std::size_t open = 0, twice_round = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const std::uint32_t n = 3 + random.below(9);
    const int rounds = n > 6 && random.below(4) == 0 ? 2 : 1;
    const double rough = random.uniform(0, 1.5);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(random.uniform(0, 6), random.direction()).toRotationMatrix();
    std::vector<Vec3> at{Vec3::Zero()};
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> together{0};
    for (std::uint32_t i = 0; i < n; ++i) {
      const double angle = 2 * M_PI * rounds * (i + random.uniform(-0.4, 0.4)) / n;
      at.push_back(turn * (random.uniform(0.5, 2) * Vec3(std::cos(angle), std::sin(angle), rough * random.uniform(-1, 1))));
      triangles.push_back({0, 1 + i, 1 + (i + 1) % n}), together.push_back(1 + i);
    }
    const bool opens = VertexFans(triangles, together).open_out(0, at);
    const std::size_t crossings = find_crossings(triangles, at, together, false).size();
    if (opens) CHECK(crossings == 0);
    if (rounds == 2) CHECK(!opens);
    open += opens, twice_round += rounds == 2;
    // One that does not close says nothing.
    triangles.pop_back();
    CHECK(!VertexFans(triangles, together).open_out(0, at));
  }
  if (count > 100) CHECK((open > static_cast<std::size_t>(count) / 5 && twice_round > 0));
}
