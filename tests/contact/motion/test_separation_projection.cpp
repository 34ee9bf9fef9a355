#include "contact/motion/separation_projection.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"

using namespace geo;

namespace {

// Whether one axis separates triangle 0 from triangle 1 at both positions: whether some n has n · d
// > 0 for all differences d of their vertices. Perceptron (Rosenblatt 1958), which finds n if there
// is one.
bool one_axis_separates(const std::vector<Triangle>& triangles, const std::vector<Vec3>& start,
                        const std::vector<Vec3>& end) {
  std::vector<Vec3> differences;
  for (const auto* at : {&start, &end})
    for (const auto v : triangles[0])
      for (const auto w : triangles[1]) differences.push_back(((*at)[v] - (*at)[w]).normalized());
  Vec3 n = Vec3::Zero();
  for (int i = 0; i < 1000000; ++i) {
    const auto worst = std::min_element(differences.begin(), differences.end(),
                                        [&](const Vec3& d, const Vec3& e) { return n.dot(d) < n.dot(e); });
    if (n.dot(*worst) > 0) return true;
    n += *worst;
  }
  return false;
}

}  // namespace

TEST_CASE("two triangles that move through each other are projected apart equally, and those that do not stay") {
  const std::vector<Triangle> triangles{{0, 1, 2}, {3, 4, 5}};
  std::vector<Vec3> start{{0, 0, 0.1}, {1, 0, 0.1}, {0, 1, 0.1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const double gap = 0.01;
  SeparationProjection projection(triangles, start, gap);
  std::vector<Vec3> next = start;
  for (std::size_t v = 0; v < 3; ++v) next[v].z() = -0.05;  // passes through the other
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs{{0, 1}};
  projection.add(pairs, next);
  projection.project(next);
  REQUIRE(projection.in_zones() == 0);
  // The middle of −0.05 and 0 stays, and each side is a little more than half a gap away from it.
  for (std::size_t v = 0; v < 3; ++v) CHECK(next[v].z() == Approx(-0.025 + 0.55 * gap).margin(1e-12));
  for (std::size_t v = 3; v < 6; ++v) CHECK(next[v].z() == Approx(-0.025 - 0.55 * gap).margin(1e-12));
  const std::vector<Vec3> before = next;
  projection.project(next);
  CHECK(next == before);
}

TEST_CASE("projected pairs are separated at the end by an axis that separated them at the start") {
  const auto [first, count] = seeds(300);
  std::size_t projected = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const std::vector<Triangle> triangles{{0, 1, 2}, {3, 4, 5}};
    std::vector<Vec3> start, next;
    for (int v = 0; v < 6; ++v)
      start.push_back(Vec3(v < 3 ? 0.7 : -0.7, 0, 0) + random.uniform(0, 0.6) * random.direction());
    for (int v = 0; v < 6; ++v) next.push_back(start[static_cast<std::size_t>(v)] + random.direction());
    SeparationProjection projection(triangles, start, 1e-3);
    const std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs{{0, 1}};
    projection.add(pairs, next);
    const std::vector<Vec3> wanted = next;
    projection.project(next);
    REQUIRE(projection.in_zones() == 0);  // they start well apart
    projected += next != wanted;
    CHECK(one_axis_separates(triangles, start, next));
  }
  REQUIRE(projected > 20);
}

TEST_CASE("rigid pairs keep their shape") {
  const std::vector<Triangle> triangles{{0, 1, 2}, {3, 4, 5}};
  Random random(1);
  std::vector<Vec3> start, next;
  for (int v = 0; v < 6; ++v) {
    start.push_back(random.direction());
    next.push_back(random.direction());
  }
  SeparationProjection projection(triangles, start, 1e-3);
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs{{0, 1}};
  projection.add(pairs, next);
  REQUIRE(projection.make_rigid(pairs));
  REQUIRE_FALSE(projection.make_rigid(pairs));
  REQUIRE(projection.is_rigid(0, 1));
  REQUIRE(projection.in_zones() == 6);
  projection.project(next);
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < i; ++j)
      CHECK((next[i] - next[j]).norm() == Approx((start[i] - start[j]).norm()).margin(1e-12));
}
