// Triangulation of one face with points and constraints.
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "crack/triangulator.h"
#include "geometry/predicates.h"
#include "kerf/error.h"

using namespace geo;
using namespace geo::crack;

namespace {

double area2(const Points& points, const std::array<PointIndex, 3>& t) {
  return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).z();
}

bool has_edge(const std::vector<Child>& children, PointIndex a, PointIndex b, int kind) {
  for (const Child& c : children)
    for (std::size_t k = 0; k < 3; ++k)
      if (c.v[k] == a && c.v[(k + 1) % 3] == b && c.edge[k] == kind) return true;
  return false;
}

}  // namespace

TEST_CASE("children cover the face once and keep its orientation") {
  const auto [first, count] = seeds(100);
  for (int c = 0; c < count; ++c) {
    Random random(first + static_cast<std::uint64_t>(c));
    INFO("seed " << first + static_cast<std::uint64_t>(c));
    Points points;
    const std::array<PointIndex, 3> corner{points.add({0, 0, 0}), points.add({8, 0, 0}), points.add({0, 8, 0})};
    std::vector<SteinerPoint> steiner{
        {points.add({3, 0, 0}), 1}, {points.add({5, 3, 0}), 2}, {points.add({0, 2, 0}), 4}};
    const std::size_t inner = 1 + static_cast<std::size_t>(5 * random.uniform());
    for (std::size_t i = 0; i < inner; ++i) {
      const double x = 0.5 + 6 * random.uniform(), y = 0.5 + (6.5 - x) * random.uniform();
      steiner.push_back({points.add({x, y, 0}), 0});
    }
    const std::pair<PointIndex, PointIndex> constraint{steiner[0].point, steiner[1].point};
    std::vector<Child> children;
    Triangulator(points).triangulate(corner, steiner, {&constraint, 1}, {}, children);
    double sum = 0;
    for (const Child& child : children) {
      CHECK(area2(points, child.v) > 0);
      sum += area2(points, child.v);
    }
    CHECK(sum == Approx(64));
    // Euler: 2 n + e + 1 triangles for n inner points and e points on edges.
    CHECK(children.size() == 2 * inner + 3 + 1);
    CHECK(has_edge(children, constraint.first, constraint.second, edge_constraint));
    CHECK(has_edge(children, constraint.second, constraint.first, edge_constraint));
    CHECK(has_edge(children, corner[0], steiner[0].point, 0));
  }
}

TEST_CASE("constraints that cross are divided at a common point, or refused") {
  Points points;
  const std::array<PointIndex, 3> corner{points.add({0, 0, 0}), points.add({8, 0, 0}), points.add({0, 8, 0})};
  const std::vector<SteinerPoint> steiner{
      {points.add({1, 1, 0}), 0}, {points.add({3, 3, 0}), 0}, {points.add({3, 1, 0}), 0}, {points.add({1, 3, 0}), 0}};
  const std::vector<std::pair<PointIndex, PointIndex>> constraints{{steiner[0].point, steiner[1].point},
                                                                   {steiner[2].point, steiner[3].point}};
  std::vector<Child> children;
  CHECK_THROWS_AS(Triangulator(points).triangulate(corner, steiner, constraints, {}, children), GeometryError);
  children.clear();
  PointIndex crossing = no_point;
  const auto canonicalize = [&](PointIndex l) { return crossing = l; };
  Triangulator(points).triangulate(corner, steiner, constraints, canonicalize, children);
  REQUIRE(crossing != no_point);
  CHECK(points[crossing] == Vec3(2, 2, 0));
  for (const SteinerPoint& s : steiner)
    CHECK((has_edge(children, s.point, crossing, edge_constraint) &&
           has_edge(children, crossing, s.point, edge_constraint)));
}

TEST_CASE("constraints that all cross each other divide a face at each crossing") {
  const auto [first, count] = seeds(10);
  for (int c = 0; c < count; ++c) {
    Random random(first + static_cast<std::uint64_t>(c));
    INFO("seed " << first + static_cast<std::uint64_t>(c));
    Points points;
    const std::array<PointIndex, 3> corner{points.add({0, 0, 0}), points.add({8, 0, 0}), points.add({0, 8, 0})};
    std::vector<SteinerPoint> steiner;
    std::vector<std::pair<PointIndex, PointIndex>> constraints;
    // The lower a constraint starts on the left, the higher it ends: n (n − 1) / 2 crossings.
    constexpr int n = 30;
    for (int i = 0; i < n; ++i) {
      const double low = i + random.uniform(0.1, 0.9), high = i + random.uniform(0.1, 0.9);
      steiner.push_back({points.add({1, 1 + 4 * low / n, 0}), 0});
      steiner.push_back({points.add({4, 3 - 2 * high / n, 0}), 0});
      constraints.push_back({steiner[2 * std::size_t(i)].point, steiner[2 * std::size_t(i) + 1].point});
    }
    std::vector<Child> children;
    std::size_t crossings = 0;
    Triangulator(points).triangulate(
        corner, steiner, constraints,
        [&](PointIndex l) {
          ++crossings;
          return l;
        },
        children);
    CHECK(crossings == std::size_t(n * (n - 1) / 2));
    CHECK(children.size() == 2 * (steiner.size() + crossings) + 1);
    double sum = 0;
    for (const Child& child : children) sum += area2(points, child.v);
    CHECK(sum == Approx(64));
  }
}

TEST_CASE("a face without area is refused") {
  Points points;
  const std::array<PointIndex, 3> corner{points.add({0, 0, 0}), points.add({1, 1, 1}), points.add({2, 2, 2})};
  std::vector<Child> children;
  CHECK_THROWS_AS(Triangulator(points).triangulate(corner, {}, {}, {}, children), GeometryError);
}
