#include <CGAL/Exact_rational.h>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "geometry/bvh.h"
#include "geometry/orientation_lanes.h"
#include "geometry/predicates.h"
#include "geometry/triangle_index.h"

using namespace geo;

namespace {

using Rational = CGAL::Exact_rational;

int oracle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Rational m[3][3];
  for (int i = 0; i < 3; ++i) {
    m[0][i] = Rational(b[i]) - Rational(a[i]);
    m[1][i] = Rational(c[i]) - Rational(a[i]);
    m[2][i] = Rational(d[i]) - Rational(a[i]);
  }
  const Rational det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                       m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                       m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return det > 0 ? 1 : det < 0 ? -1 : 0;
}

Vec3 grid_point(Random& random, int n) {
  return {double(random.below(n)), double(random.below(n)), double(random.below(n))};
}

}  // namespace

TEST_CASE("orient3d is exact on random, nearly coplanar and scaled points") {
  const std::uint64_t seed = GENERATE(1, 2, 3);
  CAPTURE(seed);
  Random random(seed);
  for (int i = 0; i < cases(3000); ++i) {
    const double scale = std::pow(10.0, random.uniform(-6, 6)), shift = random.below(3) ? 0 : 1e6;
    Vec3 p[4];
    for (auto& x : p) x = scale * random.direction() + Vec3::Constant(shift);
    if (random.below(2)) {
      p[3] = p[0] + random.uniform() * (p[1] - p[0]) + random.uniform() * (p[2] - p[0]);
      if (random.below(2)) p[3].x() = std::nextafter(p[3].x(), 1e9);
    }
    CAPTURE(i);
    CHECK(orient3d(p[0], p[1], p[2], p[3]) == oracle(p[0], p[1], p[2], p[3]));
  }
  CHECK(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}) == 1);
}

TEST_CASE("filtered orientations of many points are exact or undecided") {
  const std::uint64_t seed = GENERATE(4, 5);
  CAPTURE(seed);
  Random random(seed);
  std::size_t decided = 0, queried = 0, coplanar = 0;
  for (int i = 0; i < cases(100); ++i) {
    const bool grid = random.below(2);
    const double scale = std::pow(10.0, random.uniform(-6, 6)), shift = random.below(3) ? 0 : 1e6;
    const auto point = [&] {
      return grid ? grid_point(random, 5) : Vec3(scale * random.direction() + Vec3::Constant(shift));
    };
    const std::array<Vec3, 3> t{point(), point(), point()};
    std::vector<double> x(128), y(128), z(128);
    for (std::size_t k = 0; k < 128; ++k) {
      const Vec3 p =
          random.below(3) ? point() : Vec3(t[0] + random.uniform() * (t[1] - t[0]) + random.uniform() * (t[2] - t[0]));
      x[k] = p.x();
      y[k] = p.y();
      z[k] = p.z();
    }
    const double* const at[3] = {x.data(), y.data(), z.data()};
    std::uint64_t above[2], below[2];
    filtered_orientations(t, at, 2, above, below);
    for (std::size_t k = 0; k < 128; ++k) {
      const int side = oracle(t[0], t[1], t[2], {x[k], y[k], z[k]}), over = above[k / 64] >> k % 64 & 1,
                under = below[k / 64] >> k % 64 & 1;
      CAPTURE(i, k);
      CHECK((over + under == 0 || over - under == side));
      ++queried;
      decided += static_cast<std::size_t>(over + under);
      coplanar += side == 0;
    }
  }
  CHECK(decided > queried / 3);
  CHECK(coplanar > 0);
}

TEST_CASE("a closed segment meets a closed triangle where it touches it") {
  const Vec3 a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  CHECK(segment_meets_triangle({1, 1, -1}, {1, 1, 1}, a, b, c));
  CHECK(segment_meets_triangle({1, 1, 0}, {1, 1, 1}, a, b, c));   // its end on the face
  CHECK(segment_meets_triangle({0, 0, -1}, {0, 0, 1}, a, b, c));  // through a corner
  CHECK(segment_meets_triangle({2, -1, 0}, {2, 5, 0}, a, b, c));  // in its plane
  CHECK_FALSE(segment_meets_triangle({5, 5, -1}, {5, 5, 1}, a, b, c));
  CHECK_FALSE(segment_meets_triangle({1, 1, 0.5}, {1, 1, 1}, a, b, c));
  CHECK_FALSE(segment_meets_triangle({5, 0, 0}, {6, 0, 0}, a, b, c));
}

TEST_CASE("segment and triangle agree with exact signs on grid points") {
  const std::uint64_t seed = GENERATE(11, 12);
  CAPTURE(seed);
  Random random(seed);
  int hits = 0;
  for (int i = 0; i < cases(4000); ++i) {
    const Vec3 a = grid_point(random, 5), b = grid_point(random, 5), c = grid_point(random, 5),
               p = grid_point(random, 5), q = grid_point(random, 5);
    const int sp = oracle(a, b, c, p), sq = oracle(a, b, c, q);
    if (sp * sq >= 0 || collinear(a, b, c)) continue;  // the generic part of the oracle
    const int e0 = oracle(p, q, a, b), e1 = oracle(p, q, b, c), e2 = oracle(p, q, c, a);
    const bool expected = (e0 >= 0 && e1 >= 0 && e2 >= 0) || (e0 <= 0 && e1 <= 0 && e2 <= 0);
    hits += expected;
    CAPTURE(i);
    CHECK(segment_meets_triangle(p, q, a, b, c) == expected);
  }
  CHECK(hits > 20);
}

TEST_CASE("half-planes are compared by their angle around a line") {
  const Vec3 u(0, 0, 0), v(0, 0, 1), zero(1, 0, 0);
  const Vec3 turn[] = {{1, 0, 3}, {1, 1, 0}, {0, 1, 5}, {-1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}, {0, -1, 0}, {1, -1, 0}};
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) CHECK(compare_angle(u, v, zero, turn[i], turn[j]) == (i < j ? -1 : i > j ? 1 : 0));
}

TEST_CASE("the triangle index finds what a scan finds, whatever the sizes") {
  const std::uint64_t seed = GENERATE(5, 6, 7);
  CAPTURE(seed);
  Random random(seed);
  TriangleIndex index;
  std::vector<Box3> boxes;
  const auto box = [&](double size) {
    Box3 b;
    b.add(4 * random.direction());
    b.add(b.lo + size * random.uniform() * random.direction());
    return b;
  };
  const double sizes[] = {1, 1, 0.01, 1e-9, 0, 30};
  for (std::uint32_t i = 0; i < 300; ++i) {
    boxes.push_back(box(sizes[i % 6]));
    index.insert(i, boxes[i]);
  }
  for (std::uint32_t i = 0; i < 300; i += 4) {
    index.erase(i);
    boxes[i] = Box3{};
  }
  for (int q = 0; q < 200; ++q) {
    const Box3 query = box(sizes[q % 6]);
    std::vector<std::uint32_t> found, expected;
    index.find(query, found);
    for (std::uint32_t i = 0; i < 300; ++i)
      if (!boxes[i].empty() && boxes[i].meets(query)) expected.push_back(i);
    CHECK(found == expected);
  }
}

TEST_CASE("a segment is blocked by the tree if a triangle of the soup meets it") {
  Random random(9);
  std::vector<std::array<Vec3, 3>> soup;
  for (int i = 0; i < 200; ++i) {
    const Vec3 at = 2 * random.direction();
    soup.push_back({at, at + 0.5 * random.direction(), at + 0.5 * random.direction()});
  }
  const TriangleBvh tree(soup);
  for (int q = 0; q < 500; ++q) {
    const Vec3 a = 3 * random.direction(), b = 3 * random.direction();
    bool blocked = false;
    for (const auto& t : soup) blocked |= segment_meets_triangle(a, b, t[0], t[1], t[2]);
    CHECK(tree.blocks(a, b) == blocked);
  }
}
