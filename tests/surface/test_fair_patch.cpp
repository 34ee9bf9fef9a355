// Fair patches in holes of planes and spheres.
#include "surface/fair_patch.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "base/random.h"
#include "cases.h"

using namespace geo;

namespace {

// A hole with the surface around it: a rim at uneven angles about an axis, and two vertices beyond
// each of its corners.
struct Hole {
  std::vector<Vec3> rim;
  std::vector<std::vector<Vec3>> beyond;
  // `at(angle, reach)`: a point of the surface. The rim has reaches of 1 ± `jagged`, more is
  // beyond.
  template <class At>
  Hole(Random& random, double jagged, const At& at) {
    const std::uint32_t corners = 12 + random.below(20);
    for (std::uint32_t i = 0; i < corners; ++i) {
      const double angle = 6.283185307179586 * (i + random.uniform(-0.25, 0.25)) / corners,
                   reach = random.uniform(1 - jagged, 1 + jagged);
      rim.push_back(at(angle, reach));
      beyond.push_back({at(angle - 1.5 / corners, reach + 0.3), at(angle + 1.5 / corners, reach + 0.3)});
    }
  }
  FairPatch patch() const {
    return fair_patch(rim, beyond, [](std::uint32_t, std::uint32_t) { return false; });
  }
};

std::vector<Vec3> corners_of(const Hole& hole, const FairPatch& patch) {
  std::vector<Vec3> at = hole.rim;
  at.insert(at.end(), patch.inner.begin(), patch.inner.end());
  return at;
}

// A disk whose border is the rim, in its direction.
void check_disk(const Hole& hole, const FairPatch& patch) {
  const std::size_t corners = hole.rim.size() + patch.inner.size();
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> runs;
  std::vector<bool> used(corners);
  for (const auto& t : patch.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      REQUIRE(t[k] < corners);
      used[t[k]] = true;
      ++runs[{t[k], t[(k + 1) % 3]}];
    }
  CHECK(std::count(used.begin(), used.end(), false) == 0);
  std::size_t edges = 0, border = 0;
  for (const auto& [edge, times] : runs) {
    CHECK(times == 1);
    const bool open = runs.count({edge.second, edge.first}) == 0;
    edges += open || edge.first < edge.second;
    border += open;
    if (open) CHECK(edge.second == (edge.first + 1) % hole.rim.size());
  }
  CHECK(border == hole.rim.size());
  CHECK(corners + patch.triangles.size() == edges + 1);  // Euler: V − E + F = 1
  REQUIRE(patch.between.size() == patch.inner.size());
  for (std::size_t i = 0; i < patch.between.size(); ++i)
    for (const auto c : patch.between[i]) CHECK(c < hole.rim.size() + i);
}

// The longest edge of the patch over the longest of the rim.
double coarseness(const Hole& hole, const FairPatch& patch) {
  double inside = 0, around = 0;
  const auto at = corners_of(hole, patch);
  for (std::size_t i = 0; i < hole.rim.size(); ++i)
    around = std::max(around, (hole.rim[i] - hole.rim[(i + 1) % hole.rim.size()]).norm());
  for (const auto& t : patch.triangles)
    for (std::size_t k = 0; k < 3; ++k) inside = std::max(inside, (at[t[k]] - at[t[(k + 1) % 3]]).norm());
  return inside / around;
}

}  // namespace

TEST_CASE("a patch in a plane is a disk of the plane with the hole's area, as fine as its rim") {
  const auto [first, count] = seeds(30);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const double size = std::pow(10.0, random.uniform(-3, 3));
    const Vec3 n = random.direction(), u = n.unitOrthogonal(), v = n.cross(u), off = 10 * size * random.direction();
    const Hole hole(random, 0.1, [&](double angle, double reach) {
      return Vec3(off + size * reach * (std::cos(angle) * u + std::sin(angle) * v));
    });
    const FairPatch patch = hole.patch();
    check_disk(hole, patch);
    REQUIRE(patch.inner.size() > 3);
    for (const Vec3& p : patch.inner) CHECK(std::abs((p - off).dot(n)) < 1e-9 * size);
    Vec3 area = Vec3::Zero(), expected = Vec3::Zero();
    const auto at = corners_of(hole, patch);
    for (const auto& t : patch.triangles) {
      const Vec3 own = 0.5 * (at[t[1]] - at[t[0]]).cross(at[t[2]] - at[t[0]]);
      CHECK(own.dot(n) > 0);  // nothing is folded over
      area += own;
    }
    for (std::size_t i = 0; i < hole.rim.size(); ++i)
      expected += 0.5 * (hole.rim[i] - off).cross(hole.rim[(i + 1) % hole.rim.size()] - off);
    CHECK((area - expected).norm() < 1e-9 * size * size);
    CHECK(coarseness(hole, patch) < 2.5);
  }
}

TEST_CASE("a patch continues a sphere: it is far nearer to the sphere than a flat filling would be") {
  const auto [first, count] = seeds(30);
  double sum = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const double opening = random.uniform(0.4, 0.9);  // polar angle of the rim
    const Hole hole(random, 0.03, [&](double angle, double reach) {
      const double polar = opening * reach;
      return Vec3(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar));
    });
    const FairPatch patch = hole.patch();
    check_disk(hole, patch);
    REQUIRE(patch.inner.size() > 3);
    double farthest = 0;
    for (const Vec3& p : patch.inner) farthest = std::max(farthest, std::abs(p.norm() - 1));
    const double of_flat = farthest / (1 - std::cos(opening));
    CHECK(of_flat < 0.6);
    sum += of_flat;
    CHECK(coarseness(hole, patch) < 2.5);
  }
  if (count >= 30) CHECK(sum < 0.3 * count);
}

TEST_CASE("a patch has no edge that the surface has already") {
  const auto [first, count] = seeds(60);
  std::size_t forbidden = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    // A slit: edges from side to side.
    const Hole hole(random, 0.02, [](double angle, double reach) {
      return Vec3(reach * std::cos(angle), 0.3 * reach * std::sin(angle), 0);
    });
    const auto corners = static_cast<std::uint32_t>(hole.rim.size());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> across;
    for (const auto& t : hole.patch().triangles)
      for (std::size_t k = 0; k < 3; ++k)
        if (const auto a = t[k], b = t[(k + 1) % 3]; a < b && b < corners && b - a > 1 && b - a < corners - 1)
          across.push_back({a, b});
    if (across.empty()) continue;
    const auto there = across[random.below(static_cast<std::uint32_t>(across.size()))];
    const FairPatch patch = fair_patch(hole.rim, hole.beyond, [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(std::min(a, b), std::max(a, b)) == there;
    });
    check_disk(hole, patch);
    for (const auto& t : patch.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        CHECK_FALSE(std::pair(std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])) == there);
    ++forbidden;
  }
  CHECK(4 * forbidden > static_cast<std::size_t>(count));
}
