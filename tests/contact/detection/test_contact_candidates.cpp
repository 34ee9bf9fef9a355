// Contact candidates of a motion against a double loop over all pairs.
#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "base/random.h"
#include "cases.h"
#include "contact/detection/contact_candidates.h"
#include "contact/two_sheets.h"

using namespace geo;

namespace {

struct Sheets {
  std::vector<Triangle> triangles;
  std::vector<Vec3> from, to;
  std::vector<std::uint32_t> itself;

  // Two uneven sheets of n × n squares above each other, which approach by different amounts.
  Sheets(Random& random, std::uint32_t n, double distance, double approach) {
    triangles = triangles_of_two_sheets(n);
    from = place_two_sheets(n, [&](std::uint32_t sheet, std::uint32_t i, std::uint32_t j) {
      const double x = i + 0.3 * random.uniform(), y = j + 0.3 * random.uniform();
      return Vec3(x, y, sheet * distance + 0.02 * random.uniform());
    });
    to = place_two_sheets(n, [&](std::uint32_t sheet, std::uint32_t i, std::uint32_t j) {
      return Vec3(from[(sheet * (n + 1) + i) * (n + 1) + j] - sheet * Vec3(0, 0, approach * random.uniform()));
    });
    itself = all_apart(from.size());
  }
};

Simplex simplex_of(const Triangle& t) { return {{t[0], t[1], t[2]}, 3}; }

}  // namespace

TEST_CASE("every pair that comes within reach is a candidate, separated at the start", "[candidates]") {
  const auto [first, count] = seeds(10);
  std::size_t within = 0, others = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Sheets m(random, 6, 0.3, 0.5);
    const SurfaceMotion motion{m.triangles, m.itself, m.from, m.to, 0.01, 0.05};
    BroadPhase broad_phase;
    const auto candidates = find_contact_candidates(motion, broad_phase);
    std::set<std::pair<Triangle, Triangle>> found;
    for (const ContactCandidate& c : candidates) {
      REQUIRE(c.normal.norm() == Approx(1).margin(1e-12));
      const double at_start = separation_along(c.normal, c.a, c.b, m.from);
      REQUIRE(at_start > 0);
      REQUIRE(c.gap <= motion.gap);
      REQUIRE(c.gap <= at_start + 1e-12);
      Vec3 difference = Vec3::Zero();
      for (int k = 0; k < 3; ++k)
        difference += c.closest.weights_a[k] * m.from[c.a.v[k]] - c.closest.weights_b[k] * m.from[c.b.v[k]];
      REQUIRE((difference - c.closest.difference).norm() < 1e-9);
      REQUIRE(found.insert(std::minmax(Triangle{c.a.v[0], c.a.v[1], c.a.v[2]}, Triangle{c.b.v[0], c.b.v[1], c.b.v[2]}))
                  .second);
    }
    // At the end closer than `reach`, or crossing: no axis can keep such a pair apart.
    for (std::size_t s = 0; s < m.triangles.size(); ++s)
      for (std::size_t t = s + 1; t < m.triangles.size(); ++t) {
        const Triangle &a = m.triangles[s], &b = m.triangles[t];
        if (std::any_of(a.begin(), a.end(), [&](auto v) { return std::find(b.begin(), b.end(), v) != b.end(); }))
          continue;
        const Vec3 p[3] = {m.to[a[0]], m.to[a[1]], m.to[a[2]]}, q[3] = {m.to[b[0]], m.to[b[1]], m.to[b[2]]};
        const bool near =
            closest_points(p, 3, q, 3).difference.norm() < motion.reach || triangles_cross(a, b, m.to, false);
        const bool is_candidate = found.contains(std::minmax(a, b));
        if (near) REQUIRE(is_candidate);
        within += near;
        others += is_candidate && !near;
        const Vec3 up(0, 0, 1);
        if (s < m.triangles.size() / 2 && t >= m.triangles.size() / 2 &&
            separation_along(up, simplex_of(b), simplex_of(a), m.from) > 0.2 &&
            separation_along(up, simplex_of(b), simplex_of(a), m.to) > 0.2)
          REQUIRE_FALSE(is_candidate);
      }
  }
  if (count >= 10) {
    CHECK(within > 500);
    CHECK(others < 2 * within);
  }
}

TEST_CASE("a wild motion has the candidates of a part of it, whatever the broad phase was used for before") {
  Random random(11);
  Sheets m(random, 20, 0.3, 0.5);
  const std::vector<Vec3> gentle = m.to;
  for (Vec3& x : m.to) x += random.uniform(0, 20) * random.direction();
  const auto candidates = [&](const std::vector<Vec3>& to, BroadPhase& broad_phase) {
    std::set<std::pair<Triangle, Triangle>> found;
    for (const auto& c : find_contact_candidates({m.triangles, m.itself, m.from, to, 0.01, 0.05}, broad_phase))
      found.insert(std::minmax(Triangle{c.a.v[0], c.a.v[1], c.a.v[2]}, Triangle{c.b.v[0], c.b.v[1], c.b.v[2]}));
    return found;
  };
  BroadPhase fresh, used, none;
  const auto expected = candidates(m.to, fresh);
  CHECK(fresh.pairs().size() <= BroadPhase::max_per_triangle * m.triangles.size());
  CHECK(!expected.empty());
  none.update(
      m.triangles,
      [&](std::size_t t) {
        Box3 box;
        for (const auto v : m.triangles[t]) {
          box.add(m.from[v]);
          box.add(m.to[v]);
        }
        return box;
      },
      0);
  CHECK(none.pairs().size() > BroadPhase::max_per_triangle * m.triangles.size());
  candidates(gentle, used);
  CHECK(candidates(m.to, used) == expected);
  CHECK(candidates(m.to, fresh) == expected);
}

TEST_CASE("a limit keeps the closest candidates between two owners", "[candidates]") {
  Random random(3);
  const Sheets m(random, 6, 0.3, 0.35);
  const SurfaceMotion motion{m.triangles, m.itself, m.from, m.to, 0.01, 0.05};
  std::vector<std::uint32_t> owner;
  for (std::size_t v = 0; v < m.from.size(); ++v)
    owner.push_back(static_cast<std::uint32_t>(2 * (v >= m.from.size() / 2) + (m.from[v].x() > 3)));
  BroadPhase unlimited, limited;
  const auto all = find_contact_candidates(motion, unlimited),
             some = find_contact_candidates(motion, limited, {owner, 3});
  const auto owners = [&](const ContactCandidate& c) { return std::minmax(owner[c.a.v[0]], owner[c.b.v[0]]); };
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> before, after;
  for (const auto& c : all) ++before[owners(c)];
  for (const auto& c : some) ++after[owners(c)];
  REQUIRE(before.size() >= 2);
  CHECK(before.begin()->second > 3);
  for (const auto& [pair, times] : before) CHECK((after[pair] >= 1 && after[pair] <= 3));
  for (const auto& c : some)
    CHECK(std::any_of(all.begin(), all.end(), [&](const ContactCandidate& o) {
      return std::equal(c.a.v, c.a.v + 3, o.a.v) && std::equal(c.b.v, c.b.v + 3, o.b.v);
    }));
}
