// exact_by_cgal of geometry/exact_predicates.h: CGAL's kernel of exact predicates.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/intersections.h>

#include "geometry/exact_predicates.h"

namespace geo {
namespace by_cgal {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

Point pt(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return static_cast<int>(CGAL::orientation(pt(a), pt(b), pt(c), pt(d)));
}

int orient2d(const Vec2& a, const Vec2& b, const Vec2& c) {
  return static_cast<int>(
      CGAL::orientation(Kernel::Point_2(a.x(), a.y()), Kernel::Point_2(b.x(), b.y()), Kernel::Point_2(c.x(), c.y())));
}

bool collinear(const Vec3& a, const Vec3& b, const Vec3& c) { return CGAL::collinear(pt(a), pt(b), pt(c)); }

int coplanar_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return static_cast<int>(CGAL::coplanar_orientation(pt(a), pt(b), pt(c), pt(d)));
}

bool on_segment(const Vec3& a, const Vec3& b, const Vec3& p) { return Kernel::Segment_3(pt(a), pt(b)).has_on(pt(p)); }

bool on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  return Kernel::Triangle_3(pt(a), pt(b), pt(c)).has_on(pt(p));
}

bool segments_meet(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  return CGAL::do_intersect(Kernel::Segment_3(pt(p), pt(q)), Kernel::Segment_3(pt(r), pt(s)));
}

bool segment_meets_triangle(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  return CGAL::do_intersect(Kernel::Segment_3(pt(p), pt(q)), Kernel::Triangle_3(pt(a), pt(b), pt(c)));
}

bool triangles_meet(const Vec3 (&s)[3], const Vec3 (&t)[3]) {
  return CGAL::do_intersect(Kernel::Triangle_3(pt(s[0]), pt(s[1]), pt(s[2])),
                            Kernel::Triangle_3(pt(t[0]), pt(t[1]), pt(t[2])));
}

int volume_sign(std::span<const std::array<Vec3, 3>> triangles) {
  using Exact = CGAL::Exact_rational;
  const Vec3 apex = triangles[0][0];
  Exact exact = 0;
  // Its type is not that of the difference, whose operands end with the call.
  const auto minus = [](const Vec3& p, const Vec3& q, int k) -> Exact { return Exact(p[k]) - Exact(q[k]); };
  for (const auto& corners : triangles) {
    std::array<std::array<Exact, 3>, 3> m;
    for (int row = 0; row < 3; ++row)
      for (int k = 0; k < 3; ++k) m[row][k] = minus(corners[row], apex, k);
    exact += m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) + m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  }
  return static_cast<int>(CGAL::sign(exact));
}

}  // namespace

constexpr ExactPredicates all{.orient3d = orient3d,
                              .orient2d = orient2d,
                              .collinear = collinear,
                              .coplanar_side = coplanar_side,
                              .on_segment = on_segment,
                              .on_triangle = on_triangle,
                              .segments_meet = segments_meet,
                              .segment_meets_triangle = segment_meets_triangle,
                              .triangles_meet = triangles_meet,
                              .volume_sign = volume_sign};

}  // namespace by_cgal

constexpr ExactPredicates exact_by_cgal = by_cgal::all;

}  // namespace geo
