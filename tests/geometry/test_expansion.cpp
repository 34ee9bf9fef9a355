// Orientations by expansions against CGAL's exact kernel, at and near degeneracies.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.h"
#include "cases.h"
#include "geometry/expansion.h"
#include "geometry/predicates.h"

using namespace geo;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

namespace {

Kernel::Point_3 pt(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

int expected(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return static_cast<int>(CGAL::orientation(pt(a), pt(b), pt(c), pt(d)));
}
int expected2d(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  return static_cast<int>(
      CGAL::orientation(Kernel::Point_2(a[i], a[j]), Kernel::Point_2(b[i], b[j]), Kernel::Point_2(c[i], c[j])));
}

// Moves one coordinate by a few ulps.
Vec3 nudged(Vec3 p, Random& random) {
  const auto axis = static_cast<int>(random.below(3));
  for (int n = static_cast<int>(random.below(3)); n > 0; --n) p[axis] = std::nextafter(p[axis], random.uniform(-9, 9));
  return p;
}

}  // namespace

TEST_CASE("orientations that filters leave open are those of CGAL's exact kernel") {
  const auto [first, count] = seeds(2000);
  int open = 0;
  for (int c = 0; c < count; ++c) {
    Random random(first + static_cast<std::uint64_t>(c));
    INFO("seed " << first + static_cast<std::uint64_t>(c));
    const double scale = std::ldexp(1.0, static_cast<int>(random.below(160)) - 80);
    const auto point = [&] {
      const Vec3 p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      return random.below(2) ? Vec3(scale * p) : Vec3(scale * (p * 4).array().round());
    };
    const Vec3 a = point(), b = point(), p = point();
    // On the plane, or the line, up to rounding; some exactly.
    const Vec3 flat = nudged(a + random.uniform(-2, 2) * (b - a) + random.below(3) * (p - a), random);
    const Vec3 along = nudged(a + random.below(4) * 0.5 * (b - a), random);
    CHECK(orient3d_exact(a, b, p, flat) == expected(a, b, p, flat));
    CHECK(orient3d_exact(a, b, along, p) == expected(a, b, along, p));
    CHECK(collinear(a, b, along) == CGAL::collinear(pt(a), pt(b), pt(along)));
    for (int axis = 0; axis < 3; ++axis) CHECK(orient2d(a, b, along, axis) == expected2d(a, b, along, axis));
    if (expected(a, b, p, flat) == 0 && !CGAL::collinear(pt(a), pt(b), pt(p)))
      CHECK(coplanar_side(a, b, p, flat) ==
            static_cast<int>(CGAL::coplanar_orientation(pt(a), pt(b), pt(p), pt(flat))));
    open += orient3d_filtered(a, b, p, flat) == 2;
  }
  CHECK(open > count / 4);
}

TEST_CASE("numbers beyond the range of expansions have the right orientation") {
  const double tiny = 1e-300, huge = 1e200;
  CHECK(orient3d({0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}, {0, 0, tiny}) == 1);
  CHECK(orient3d({0, 0, 0}, {huge, 0, 0}, {0, huge, 0}, {huge, huge, -tiny}) == -1);
  CHECK(orient2d({0, 0, 0}, {tiny, tiny, 0}, {2 * tiny, 2 * tiny, 0}, 2) == 0);
}

TEST_CASE("sums and products of expansions are exact") {
  const auto difference = Expansion<2>::difference(1, 0x1p-80);
  CHECK(difference.size() == 2);
  CHECK((difference - Expansion<2>::difference(1, 0)).sign() == -1);
  CHECK((difference * difference - Expansion<2>::difference(1, 0x1p-79) - Expansion<2>::difference(0, -0x1p-160))
            .sign() == 0);
  CHECK((difference - difference).size() == 0);
}
