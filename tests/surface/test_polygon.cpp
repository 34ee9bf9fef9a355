// Triangulated polygons.
#include <catch2/catch.hpp>

#include "surface/polygon.h"

using namespace geo;

namespace {

double area_of(const std::vector<Vec3>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) sum += 0.5 * (points[b] - points[a]).cross(points[c] - points[a]).z();
  return sum;
}

}  // namespace

TEST_CASE("a convex polygon is a fan, a concave one is cut into ears of its orientation") {
  const std::vector<Vec3> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  CHECK(triangles_of(square, {0, 1, 2, 3}) == std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}});
  // A chevron whose corner 2 is reflex.
  const std::vector<Vec3> chevron{{0, 0, 0}, {2, -1, 0}, {0.5, 0.1, 0}, {2, 1.5, 0}};
  const auto ears = triangles_of(chevron, {0, 1, 2, 3});
  REQUIRE(ears.size() == 2);
  double total = 0;
  for (const auto& t : ears) {
    CHECK(area_of(chevron, {t}) > 0);
    total += area_of(chevron, {t});
  }
  CHECK(total == Approx(area_of(chevron, {{0, 1, 2}, {0, 2, 3}})));
}
