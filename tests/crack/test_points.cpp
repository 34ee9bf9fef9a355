// Explicit and implicit points: predicates agree with rational positions.
#include <gmpxx.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.h"
#include "cases.h"
#include "crack/index_map.h"
#include "crack/points.h"
#include "geometry/predicates.h"

using namespace geo;
using namespace geo::crack;

TEST_CASE("an intersection point lies exactly on its plane, and between the ends of its edge") {
  const auto [first, count] = seeds(200);
  for (int c = 0; c < count; ++c) {
    Random random(first + static_cast<std::uint64_t>(c));
    INFO("seed " << first + static_cast<std::uint64_t>(c));
    const auto point = [&] { return Vec3(random.uniform(), random.uniform(), random.uniform()); };
    const Vec3 p = point(), q = point(), r = point(), a = point(), b = point();
    if (geo::orient3d(p, q, r, a) * geo::orient3d(p, q, r, b) >= 0) continue;
    Points points;
    const PointIndex lp = points.add(p), lq = points.add(q), lr = points.add(r), la = points.add(a), lb = points.add(b);
    const PointIndex x = points.add_crossing(a, b, p, q, r), y = points.add_crossing(a, b, q, r, p);
    CHECK(points.orient3d(lp, lq, lr, x) == 0);
    CHECK(points.orient3d(lp, lq, lr, la) == geo::orient3d(p, q, r, a));
    CHECK(points.coincide(x, y));
    CHECK(points.hash(x) == points.hash(y));
    CHECK_FALSE(points.coincide(x, la));
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(points.compare(la, x, axis) == points.compare(x, lb, axis));
      CHECK(points.orient2d(la, lb, x, axis) == 0);
    }
    CHECK((points[x] - (a + (b - a) * ((p - a).dot((q - p).cross(r - p)) / (b - a).dot((q - p).cross(r - p))))).norm() <
          1e-9);
  }
}

TEST_CASE("coplanar lines cross in one point, whichever line is named first") {
  Points points;
  const PointIndex a = points.add({0, 0, 0}), b = points.add({3, 3, 3}), c = points.add({3, 0, 0}),
                   d = points.add({0, 3, 3});
  const PointIndex x = points.add_crossing_in_plane(a, b, c, d, 2), y = points.add_crossing_in_plane(c, d, a, b, 2);
  CHECK(points[x] == Vec3(1.5, 1.5, 1.5));
  CHECK(points.error(x) == 0);
  CHECK(points.coincide(x, y));
}

TEST_CASE("a crossing is the double nearest to the exact fraction") {
  const auto [first, count] = seeds(2000);
  for (int c = 0; c < count; ++c) {
    Random random(first + static_cast<std::uint64_t>(c));
    INFO("seed " << first + static_cast<std::uint64_t>(c));
    // Lines through whole numbers of up to 5, 25 or 45 bits; some crossings are whole numbers.
    const double size = std::ldexp(1.0, 5 + 20 * static_cast<int>(random.below(3)));
    const auto point = [&] {
      return Vec3(std::floor(size * random.uniform(-1.0, 1.0)), std::floor(size * random.uniform(-1.0, 1.0)), 0);
    };
    const Vec3 p[4] = {point(), point(), point(), point()};
    const auto cross = [](const mpq_class(&u)[2], const mpq_class(&v)[2]) {
      return mpq_class(u[0] * v[1] - u[1] * v[0]);
    };
    const mpq_class u[2] = {mpq_class(p[1].x()) - p[0].x(), mpq_class(p[1].y()) - p[0].y()},
                    v[2] = {mpq_class(p[3].x()) - p[2].x(), mpq_class(p[3].y()) - p[2].y()},
                    w[2] = {mpq_class(p[2].x()) - p[0].x(), mpq_class(p[2].y()) - p[0].y()};
    if (cross(u, v) == 0) continue;
    const mpq_class t = cross(w, v) / cross(u, v);
    Points points;
    const PointIndex x =
        points.add_crossing_in_plane(points.add(p[0]), points.add(p[1]), points.add(p[2]), points.add(p[3]), 2);
    bool exact = true;
    for (int i = 0; i < 2; ++i) {
      const mpq_class is = p[0][i] + t * u[i];
      const double found = points[x][i];
      const mpq_class off = abs(is - mpq_class(found));
      CHECK(off <= abs(is - mpq_class(std::nextafter(found, HUGE_VAL))));
      CHECK(off <= abs(is - mpq_class(std::nextafter(found, -HUGE_VAL))));
      exact = exact && off == 0;
    }
    CHECK((points.error(x) == 0) == exact);
  }
}

TEST_CASE("equal positions have equal hashes, both zeros being one") {
  CHECK(hash_of({0.0, 1, 2}) == hash_of({-0.0, 1, 2}));
  CHECK(hash_of({0, 1, 2}) != hash_of({1, 0, 2}));
}

TEST_CASE("an index map keeps every key") {
  IndexMap<std::uint64_t, SpreadHash> map;
  CHECK(map.find(7) == ~0u);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    std::uint32_t& index = map[std::uint64_t(i) << 32 | (i * i)];
    REQUIRE(index == ~0u);
    index = i;
  }
  for (std::uint32_t i = 0; i < 1000; ++i) CHECK(map.find(std::uint64_t(i) << 32 | (i * i)) == i);
  CHECK(map.find(std::uint64_t(1000) << 32) == ~0u);
}
