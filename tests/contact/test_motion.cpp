#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "contact/bounded_motion.h"
#include "contact/crossing.h"
#include "geometry/predicates.h"
#include "surface/shapes.h"

using namespace geo;

namespace {

struct Soup {
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> together;
  std::vector<Vec3> from, to;
  void add(const TriangleMesh& m, const Vec3& at, double size) {
    const auto base = static_cast<std::uint32_t>(from.size());
    for (const Vec3& p : m.vertices) together.push_back(static_cast<std::uint32_t>(from.size())), from.push_back(at + size * p);
    for (const auto& [a, b, c] : m.triangles) triangles.push_back({a + base, b + base, c + base});
  }
  std::vector<Vec3> move(BoundedMotion* report = nullptr) const { return move_without_crossing({triangles, together, from, to, 1e-4, 2e-3}, false, report); }
  std::size_t crossings(const std::vector<Vec3>& at) const { return find_crossings(triangles, at, together, false).size(); }
};

}  // namespace

TEST_CASE("whatever a motion wants, nothing crosses at its end", "[campaign]") {
  const auto [first, count] = seeds(150);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Soup s;
    s.add(make_sphere(2), {0, 0, 0}, 1);
    s.add(make_block({1, 1, 1}, 0.5), {1.05, random.uniform(-1, 0.5), random.uniform(-1, 0.5)}, 1);
    REQUIRE(s.crossings(s.from) == 0);
    const std::uint32_t kind = random.below(4);
    const Vec3 blow = random.uniform(0, 2) * random.direction();
    const Eigen::AngleAxisd turn(random.uniform(0, 1), random.direction());
    for (std::size_t v = 0; v < s.from.size(); ++v) {
      const Vec3& x = s.from[v];
      const bool ball = v < 42;
      s.to.push_back(kind == 0 ? Vec3(x + (ball ? blow : Vec3(-blow)))                             // thrown on each other
                     : kind == 1 ? Vec3(x + random.uniform(0, 0.3) * random.direction())          // every vertex for itself
                     : kind == 2 ? Vec3(turn * x + Vec3(ball ? 0.3 : -0.3, 0, 0))                 // turning and pressed
                                 : Vec3(x.x() > 1 ? Vec3(2 - x.x(), x.y(), x.z()) : x));          // folded over: coplanar in part
    }
    const auto end = s.move();
    CHECK(s.crossings(end) == 0);
  }
}

TEST_CASE("what is clear of everything goes where it wants to, to the bit") {
  Soup s;
  s.add(make_sphere(2), {0, 0, 0}, 1);
  s.add(make_sphere(2), {4, 0, 0}, 1);
  const Eigen::AngleAxisd turn(0.2, Vec3(1, 2, 3).normalized());
  for (const Vec3& x : s.from) s.to.push_back(turn * x + Vec3(5, 5, 5));
  BoundedMotion report;
  CHECK(s.move(&report) == s.to);
  CHECK(report.in_zones == 0);
}

TEST_CASE("nothing passes through a sheet however fast it is, nor in a sheet's own plane") {
  // A small triangle before a large one.
  for (const double speed : {0.1, 1.0, 100.0, 1e4}) {
    Soup s;
    s.triangles = {{0, 1, 2}, {3, 4, 5}}, s.together = {0, 1, 2, 3, 4, 5};
    s.from = {{-5, -5, 0}, {5, -5, 0}, {0, 5, 0}, {0, 0, 0.5}, {0.1, 0, 0.5}, {0, 0.1, 0.6}};
    s.to = s.from;
    for (int v = 3; v < 6; ++v) s.to[static_cast<std::size_t>(v)].z() -= speed;
    const auto end = s.move();
    INFO(speed);
    CHECK(s.crossings(end) == 0);
    for (std::size_t v = 3; v < 6; ++v) CHECK(orient3d(end[0], end[1], end[2], end[v]) == 1);  // still on its side
    // The same in one plane: side by side, one wants to be inside the other.
    for (Vec3& p : s.from) p.z() = 0;
    s.from[3] = {6, 0, 0}, s.from[4] = {7, 0, 0}, s.from[5] = {6, 1, 0};
    s.to = s.from;
    for (std::size_t v = 3; v < 6; ++v) s.to[v].x() -= speed;
    REQUIRE(s.crossings(s.from) == 0);
    CHECK(s.crossings(s.move()) == 0);
  }
}

TEST_CASE("parts that a fixed direction parts at both ends do not meet in between") {
  // Against a slow oracle: the motion in 2,000 steps, exactly.
  const auto [first, count] = seeds(300);
  std::size_t parted_both = 0, met = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    Soup s;
    s.triangles = {{0, 1, 2}, {3, 4, 5}}, s.together = {0, 1, 2, 3, 4, 5};
    for (int v = 0; v < 6; ++v) s.from.push_back(Vec3(v < 3 ? 0 : 1, 0, 0) + random.uniform(0, 0.5) * random.direction());
    const Vec3 closer = Vec3(0.4, 0, 0) + random.uniform(0, 0.5) * random.direction();
    for (int v = 0; v < 6; ++v) s.to.push_back(s.from[static_cast<std::size_t>(v)] + (v < 3 ? closer : Vec3(-closer)) + random.uniform(0, 0.3) * random.direction());
    if (s.crossings(s.from) > 0) continue;
    const auto watched = watch({s.triangles, s.together, s.from, s.to, 1e-4, 2e-3});
    bool meets = false;
    for (int step = 0; step <= 2000 && !meets; ++step) {
      std::vector<Vec3> at;
      for (std::size_t v = 0; v < 6; ++v) at.push_back(s.from[v] + step / 2000.0 * (s.to[v] - s.from[v]));
      meets = s.crossings(at) > 0;
    }
    if (meets) {
      ++met;
      CHECK_FALSE(watched.empty());  // nothing that meets goes unwatched
    } else if (watched.empty()) {
      ++parted_both;
    }
  }
  CHECK(met > 20);
  CHECK(parted_both > 20);
}
