// Both sets of exact predicates agree: CGAL's and Kerf's own.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "base/random.h"
#include "cases.h"
#include "geometry/exact_predicates.h"

using namespace geo;

namespace {

// Points of a small grid, where nearly all cases are degenerate; of a grid that is far away, whose
// coordinates have other bits; or nearly on a plane through three others.
class Points {
 public:
  explicit Points(Random& random)
      : random_(random), kind_(random.below(4)), unit_(std::ldexp(1.0, int(random.below(200)) - 100)) {}
  Vec3 next() {
    const int n = 2 + int(kind_);
    Vec3 p(double(random_.below(n)), double(random_.below(n)), double(random_.below(n)));
    if (kind_ == 1) p *= unit_;
    if (kind_ == 2) p = Vec3::Constant(1e15) + 0.125 * p;
    if (kind_ == 3 && random_.below(2)) p = p.cwiseProduct(Vec3(unit_, 1, 1)) + Vec3(0, 0, 0x1p-52);
    return p;
  }

 private:
  Random& random_;
  std::uint64_t kind_;
  double unit_;
};

void compare(Random& random) {
  Points points(random);
  const Vec3 a = points.next(), b = points.next(), c = points.next(), d = points.next(), e = points.next(),
             f = points.next();
  const ExactPredicates &x = exact_by_cgal, &y = exact_by_integers;
  CHECK(x.orient3d(a, b, c, d) == y.orient3d(a, b, c, d));
  CHECK(x.orient2d(a.head<2>(), b.head<2>(), c.head<2>()) == y.orient2d(a.head<2>(), b.head<2>(), c.head<2>()));
  CHECK(x.collinear(a, b, c) == y.collinear(a, b, c));
  const std::vector<std::array<Vec3, 3>> triangles{{a, b, c}, {d, e, f}};
  CHECK(x.volume_sign(triangles) == y.volume_sign(triangles));
  const bool area = !x.collinear(a, b, c);
  if (area && x.orient3d(a, b, c, d) == 0) CHECK(x.coplanar_side(a, b, c, d) == y.coplanar_side(a, b, c, d));
  if (a != b) CHECK(x.on_segment(a, b, c) == y.on_segment(a, b, c));
  if (area) CHECK(x.on_triangle(a, b, c, d) == y.on_triangle(a, b, c, d));
  if (a != b && c != d) CHECK(x.segments_meet(a, b, c, d) == y.segments_meet(a, b, c, d));
  if (area && d != e) CHECK(x.segment_meets_triangle(d, e, a, b, c) == y.segment_meets_triangle(d, e, a, b, c));
  if (area && !x.collinear(d, e, f)) {
    const Vec3 s[3] = {a, b, c}, t[3] = {d, e, f};
    CHECK(x.triangles_meet(s, t) == y.triangles_meet(s, t));
  }
}

}  // namespace

TEST_CASE("predicates on whole numbers agree with CGAL's, on degenerate points") {
  const auto [first, count] = seeds(20000);
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    CAPTURE(seed);
    Random random(seed);
    compare(random);
  }
}

TEST_CASE("predicates on whole numbers hold for coordinates of any size") {
  const ExactPredicates& exact = exact_by_integers;
  const double tiny = 0x1p-1074, huge = 1e60;
  CHECK(exact.orient3d({0, 0, 0}, {huge, 0, 0}, {0, huge, 0}, {0, 0, tiny}) == 1);
  CHECK(exact.orient3d({0, 0, 0}, {huge, 0, tiny}, {0, huge, 0}, {huge, huge, tiny}) == 0);
  CHECK(exact.orient3d({0, 0, 0}, {huge, 0, tiny}, {0, huge, 0}, {huge, huge, 0}) == -1);
  CHECK(exact.orient2d({0, 0}, {huge, tiny}, {2 * huge, 2 * tiny}) == 0);
  CHECK(exact.orient2d({0, 0}, {huge, tiny}, {2 * huge, 3 * tiny}) == 1);
}
