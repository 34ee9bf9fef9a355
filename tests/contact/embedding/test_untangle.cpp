// Untangling separates crossing triangles in the order that they have in the material.
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "contact/embedding/untangle.h"

using namespace geo;

namespace {

// Triangles that are disjoint at rest, and given positions where they cross.
struct Tangle {
  ContactSurface surface;
  std::vector<Vec3> rest, positions;
  std::vector<std::uint8_t> fresh, marked;

  std::vector<TrianglePair> untangle(double gap, const Mat3& gradient = Mat3::Identity()) {
    surface.site.resize(rest.size());
    for (std::uint32_t v = 0; v < rest.size(); ++v) surface.site[v] = v;
    const UntangleInput input{.surface = surface,
                              .rest = [&](std::uint32_t v) { return rest[v]; },
                              .gradient = [&](std::uint32_t) { return gradient; },
                              .fresh = fresh,
                              .gap = gap,
                              .reach = 0};
    return geo::untangle(input, positions, marked);
  }
};

// Two parallel triangles, the second above the first at rest, by `distance`; below it as given.
Tangle swapped(double distance) {
  Tangle t;
  t.rest = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {-1, -1, distance}, {0, 1, distance}, {1, -1, distance}};
  t.positions = t.rest;
  t.positions[4].z() = -0.3 * distance;  // one corner has passed through
  t.surface.triangles = {{0, 1, 2}, {3, 4, 5}};
  t.fresh = t.marked = {1, 1};
  return t;
}

}  // namespace

TEST_CASE("triangles that cross are separated as they are at rest", "[untangle]") {
  Tangle t = swapped(0.01);
  t.positions[4] = {0, 0.5, -0.003};
  t.positions[5] = {0.5, -0.5, -0.003};
  REQUIRE(find_crossings(t.surface.triangles, t.positions, std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}, true).size() ==
          1);
  CHECK(t.untangle(0.001).empty());
  // The second triangle is above the first again, and neither moved farther than needed.
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 3; j < 6; ++j) CHECK(t.positions[j].z() > t.positions[i].z());
  for (const Vec3& p : t.positions) CHECK(std::abs(p.z()) < 0.011);
}

TEST_CASE("nothing moves without crossings among marked triangles", "[untangle]") {
  Tangle t = swapped(0.01);
  t.positions = t.rest;
  CHECK(t.untangle(0.001).empty());
  CHECK(t.positions == t.rest);
  t = swapped(0.01);
  t.positions[4] = {0, 0.5, -0.003};
  t.positions[5] = {0.5, -0.5, -0.003};
  const auto before = t.positions;
  t.marked = {0, 0};
  CHECK(t.untangle(0.001).empty());
  CHECK(t.positions == before);
}

TEST_CASE("fresh triangles are untangled along the deformed direction, and moved ones are marked", "[untangle]") {
  // The material has turned by a right angle about x: rest z is now y.
  Mat3 turn;
  turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  Tangle t = swapped(0.01);
  t.positions[4] = {0, 0.5, -0.003};
  t.positions[5] = {0.5, -0.5, -0.003};
  for (Vec3& p : t.positions) p = turn * p;
  t.surface.triangles.push_back({6, 7, 8});
  t.rest.insert(t.rest.end(), {{5, 5, 5}, {6, 5, 5}, {5, 6, 5}});
  t.positions.insert(t.positions.end(), t.rest.end() - 3, t.rest.end());
  t.fresh = {1, 1, 1};
  t.marked = {1, 0, 0};
  CHECK(t.untangle(0.001, turn).empty());
  const Vec3 up = turn * Vec3(0, 0, 1);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 3; j < 6; ++j) CHECK(up.dot(t.positions[j]) > up.dot(t.positions[i]));
  CHECK(t.marked == std::vector<std::uint8_t>{1, 1, 0});
}
