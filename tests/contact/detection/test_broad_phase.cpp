// The broad phase against a double loop, and fans of triangles that are height fields.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/random.h"
#include "cases.h"
#include "contact/detection/broad_phase.h"
#include "contact/detection/find_crossings.h"
#include "contact/detection/vertex_fans.h"

using namespace geo;

TEST_CASE("the broad phase keeps every pair whose boxes meet, each once, from update to update", "[campaign]") {
  const auto [first, count] = seeds(30);
  std::size_t supersets = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    std::vector<Box3> boxes(40 + random.below(200));
    for (Box3& b : boxes) {
      b.add(Vec3(random.uniform(0, 3), random.uniform(0, 3), random.uniform(0, 3)));
      b = b.grown(random.uniform(0, 0.3));
    }
    // Some triangles share a corner.
    std::vector<Triangle> triangles;
    for (std::uint32_t t = 0; t < boxes.size(); ++t)
      triangles.push_back(
          {3 * t, 3 * t + 1,
           random.below(2) == 0 ? 3 * t + 2 : 3 * random.below(static_cast<std::uint32_t>(boxes.size()))});
    const auto neighbours = [&](std::uint32_t i, std::uint32_t j) {
      return std::any_of(triangles[i].begin(), triangles[i].end(), [&](auto v) {
        return std::find(triangles[j].begin(), triangles[j].end(), v) != triangles[j].end();
      });
    };
    BroadPhase broad_phase;
    std::vector<std::uint8_t> changed(boxes.size(), 1);
    for (int call = 0; call < 8; ++call) {
      const bool anew = random.below(3) == 0;  // another step
      if (anew) broad_phase.invalidate();
      if (random.below(5) == 0) {  // other triangles, of the same number
        for (Triangle& t : triangles)
          std::swap(t[2], triangles[random.below(static_cast<std::uint32_t>(triangles.size()))][2]);
        broad_phase.reset();
      }
      const bool changed_only = call > 0 && random.below(2) == 0;
      std::size_t meeting = 0;
      for (std::uint32_t i = 0; i < boxes.size(); ++i)
        for (std::uint32_t j = i + 1; j < boxes.size(); ++j) meeting += boxes[i].meets(boxes[j]) && !neighbours(i, j);
      const auto box = [&](std::size_t t) { return boxes[t]; };
      const double margin = random.uniform(0, 0.1);
      const auto bounded = [&](std::size_t most) {
        return broad_phase.update(triangles, box, margin, changed_only ? &changed : nullptr, most);
      };
      const auto kind = random.below(4);  // bounds that hold just so, or just do not, from pairs of any update
      if (kind == 0 && meeting > 0) {
        CHECK(!bounded(meeting - 1));
        CHECK(broad_phase.pairs().empty());
      }
      if (kind <= 1) {
        const std::size_t before = broad_phase.pairs().size();
        CHECK(bounded(meeting));
        CHECK(broad_phase.pairs().size() <= meeting);
        supersets += before > meeting;
      }
      broad_phase.update(triangles, box, margin, changed_only ? &changed : nullptr);
      const std::set<BroadPhase::Pair> pairs(broad_phase.pairs().begin(), broad_phase.pairs().end());
      CHECK(pairs.size() == broad_phase.pairs().size());
      std::size_t missing = 0;
      for (std::uint32_t i = 0; i < boxes.size(); ++i)
        for (std::uint32_t j = i + 1; j < boxes.size(); ++j)
          missing += boxes[i].meets(boxes[j]) && !neighbours(i, j) && !pairs.contains({i, j});
      CHECK(missing == 0);
      if (anew)
        CHECK(std::all_of(pairs.begin(), pairs.end(),
                          [&](const auto& p) { return boxes[p.first].meets(boxes[p.second]); }));
      CHECK(std::none_of(pairs.begin(), pairs.end(), [&](const auto& p) { return neighbours(p.first, p.second); }));
      // Few or many triangles move.
      const double share = random.below(3) == 0 ? 0.5 : 0.03;
      for (std::size_t t = 0; t < boxes.size(); ++t) {
        changed[t] = random.uniform(0, 1) < share;
        const Vec3 move = 0.4 * random.direction();
        if (changed[t]) {
          boxes[t].lo += move;
          boxes[t].hi += move;
        }
      }
    }
  }
  if (count >= 30) CHECK(supersets > 0);
}

TEST_CASE("a motion has the largest share with few pairs more than at rest") {
  const std::uint32_t n = 2000;
  std::vector<Triangle> triangles;
  for (std::uint32_t t = 0; t < n; ++t) triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  const double way = 4 * BroadPhase::max_per_triangle;
  for (const double at_rest : {0.0, 1.0}) {  // boxes of which none, or all, meet at rest
    double share = 1;
    const auto box = [&](std::size_t t) {
      const double from = at_rest == 0 ? double(t) : 0.0;
      return Box3{{from, 0, 0}, {from + 0.5 + share * way, 1, 1}};
    };
    const auto take = [&](double s) { share = s; };
    BroadPhase broad_phase;
    CHECK(broad_phase.update_for_share(triangles, box, 0, take) == (at_rest == 0 ? 0.25 : 1));
    CHECK(share == (at_rest == 0 ? 0.25 : 1));
    CHECK(broad_phase.pairs().size() <= broad_phase.most_of_motion());
    CHECK(broad_phase.most_of_motion() ==
          BroadPhase::max_per_triangle * n + (at_rest == 0 ? 0 : n * std::size_t(n - 1) / 2));
    if (at_rest == 1) continue;
    CHECK(broad_phase.update_for_share(triangles, box, 0, take) == 1);  // of what is left
    // No share of so long a way has few pairs.
    const auto far = [&](std::size_t t) {
      return Box3{{double(t), 0, 0}, {double(t) + 0.5 + (share > 0 ? share * 1e9 : 0), 1, 1}};
    };
    share = 1;
    CHECK(broad_phase.update_for_share(triangles, far, 0, take) == 0);
    CHECK(broad_phase.pairs().empty());
  }
}

TEST_CASE("fans visit each pair of triangles with a common vertex once") {
  Random random(7);
  const std::uint32_t vertices = 12;
  std::vector<Triangle> triangles;
  while (triangles.size() < 40) {
    const Triangle t{random.below(vertices), random.below(vertices), random.below(vertices)};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
  }
  const VertexFans fans(triangles, vertices);
  std::vector<BroadPhase::Pair> visited, expected;
  for (std::uint32_t v = 0; v < vertices; ++v)
    fans.for_each_pair(
        v, [v](std::uint32_t w) { return w < v; },
        [&](std::uint32_t s, std::uint32_t t) {
          visited.push_back({s, t});
        });
  for (std::uint32_t s = 0; s < triangles.size(); ++s)
    for (std::uint32_t t = s + 1; t < triangles.size(); ++t)
      if (std::any_of(triangles[s].begin(), triangles[s].end(), [&](auto v) {
            return std::find(triangles[t].begin(), triangles[t].end(), v) != triangles[t].end();
          }))
        expected.push_back({s, t});
  std::sort(visited.begin(), visited.end());
  CHECK(visited == expected);
}

TEST_CASE("no two triangles of a certified fan cross, and a fan that winds twice around its vertex is not certified",
          "[campaign]") {
  const auto [first, count] = seeds(3000);
  std::size_t certified_fans = 0, twice_round = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const std::uint32_t n = 3 + random.below(9);
    const int rounds = n > 6 && random.below(4) == 0 ? 2 : 1;
    const double rough = random.uniform(0, 1.5);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(random.uniform(0, 6), random.direction()).toRotationMatrix();
    std::vector<Vec3> at{Vec3::Zero()};
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> representative{0};
    for (std::uint32_t i = 0; i < n; ++i) {
      const double angle = 2 * M_PI * rounds * (i + random.uniform(-0.4, 0.4)) / n;
      at.push_back(turn *
                   (random.uniform(0.5, 2) * Vec3(std::cos(angle), std::sin(angle), rough * random.uniform(-1, 1))));
      triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
      representative.push_back(1 + i);
    }
    const auto certified = [&] {
      std::vector<std::uint8_t> result(at.size(), 0);
      const auto uncertified =
          VertexFans(triangles, at.size())
              .find_uncertified(std::vector<std::uint8_t>(triangles.size(), 1), representative, at, result);
      CHECK((std::find(uncertified.begin(), uncertified.end(), 0u) == uncertified.end()) == (result[0] != 0));
      return result[0] != 0;
    };
    const bool is_certified = certified();
    std::size_t crossings = 0;
    for (std::size_t s = 0; s < triangles.size(); ++s)
      for (std::size_t t = s + 1; t < triangles.size(); ++t)
        crossings += triangles_cross(triangles[s], triangles[t], at, false);
    if (is_certified) CHECK(crossings == 0);
    if (rounds == 2) CHECK(!is_certified);
    certified_fans += is_certified;
    twice_round += rounds == 2;
    // An open fan is never certified.
    triangles.pop_back();
    CHECK(!certified());
  }
  if (count > 100) CHECK((certified_fans > static_cast<std::size_t>(count) / 5 && twice_round > 0));
}
