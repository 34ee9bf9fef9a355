#include "geometry/predicates.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <cmath>

namespace geo {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

Point pt(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

// Below this a product of three differences may underflow, and the error bound no longer holds.
constexpr double smallest = 1e-270, largest = 1e300;

// Sign of det(b−a, c−a, d−a), or 2 when rounding could have changed it. The bound is Shewchuk's (1997) A-stage of
// orient3d, (7 + 56 ε) ε with ε = 2⁻⁵³, times the permanent.
int orient3d_filtered(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double adx = a.x() - d.x(), ady = a.y() - d.y(), adz = a.z() - d.z();
  const double bdx = b.x() - d.x(), bdy = b.y() - d.y(), bdz = b.z() - d.z();
  const double cdx = c.x() - d.x(), cdy = c.y() - d.y(), cdz = c.z() - d.z();
  const double bc = bdx * cdy, cb = cdx * bdy, ca = cdx * ady, ac = adx * cdy, ab = adx * bdy, ba = bdx * ady;
  const double det = adz * (bc - cb) + bdz * (ca - ac) + cdz * (ab - ba);
  const double permanent = (std::abs(bc) + std::abs(cb)) * std::abs(adz) + (std::abs(ca) + std::abs(ac)) * std::abs(bdz) +
                           (std::abs(ab) + std::abs(ba)) * std::abs(cdz);
  constexpr double bound = 7.771561172376103e-16;
  if (!(permanent > smallest && permanent < largest)) return 2;
  // Shewchuk's determinant is positive when d is below abc; ours the other way round.
  return det > bound * permanent ? -1 : det < -bound * permanent ? 1 : 2;
}

// Sign of the turn abc, or 2. Shewchuk's A-stage of orient2d: (3 + 16 ε) ε.
int orient2d_filtered(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const double left = (a[i] - c[i]) * (b[j] - c[j]), right = (a[j] - c[j]) * (b[i] - c[i]);
  const double value = left - right, terms = std::abs(left) + std::abs(right);
  if (!(terms > smallest && terms < largest)) return 2;
  return value > 3.3306690738754716e-16 * terms ? 1 : value < -3.3306690738754716e-16 * terms ? -1 : 2;
}

bool same(const Vec3& a, const Vec3& b) { return a == b; }

// The extreme points of collinear a, b, c: the segment that a degenerate triangle is.
std::pair<Vec3, Vec3> as_segment(const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto less = [](const Vec3& p, const Vec3& q) {
    return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
  };
  return {std::min({a, b, c}, less), std::max({a, b, c}, less)};
}

bool segments_meet(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  if (same(p, q) && same(r, s)) return same(p, r);
  if (same(p, q)) return Kernel::Segment_3(pt(r), pt(s)).has_on(pt(p));
  if (same(r, s)) return Kernel::Segment_3(pt(p), pt(q)).has_on(pt(r));
  return CGAL::do_intersect(Kernel::Segment_3(pt(p), pt(q)), Kernel::Segment_3(pt(r), pt(s)));
}

}  // namespace

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const int sign = orient3d_filtered(a, b, c, d);
  if (sign != 2) return sign;
  return static_cast<int>(CGAL::orientation(pt(a), pt(b), pt(c), pt(d)));
}

int orient3d_quick(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return orient3d_filtered(a, b, c, d); }

int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int sign = orient2d_filtered(a, b, c, axis), i = (axis + 1) % 3, j = (axis + 2) % 3;
  if (sign != 2) return sign;
  return static_cast<int>(CGAL::orientation(Kernel::Point_2(a[i], a[j]), Kernel::Point_2(b[i], b[j]), Kernel::Point_2(c[i], c[j])));
}

bool collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  // A clearly non-zero component of the cross product settles it; each has an error of at most 4 ε times its terms.
  const Vec3 u = b - a, v = c - a;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double x = u[j] * v[k], y = u[k] * v[j], terms = std::abs(x) + std::abs(y);
    if (terms > smallest && terms < largest && std::abs(x - y) > 5e-16 * terms) return false;
  }
  return CGAL::collinear(pt(a), pt(b), pt(c));
}

int coplanar_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return static_cast<int>(CGAL::coplanar_orientation(pt(a), pt(b), pt(c), pt(d)));
}

bool share_corners_only(const Vec3 (&s)[3], const Vec3 (&t)[3]) {
  int axis = 0;
  (s[1] - s[0]).cross(s[2] - s[0]).cwiseAbs().maxCoeff(&axis);
  // An edge of one that has the other strictly on its far side, but for corners that the two share on it.
  const auto divides = [axis](const Vec3(&x)[3], const Vec3(&y)[3]) {
    const int turn = orient2d_filtered(x[0], x[1], x[2], axis);
    if (turn == 2) return false;
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = x[k], &b = x[(k + 1) % 3];
      bool beyond = true;
      for (int j = 0; j < 3 && beyond; ++j) beyond = y[j] == a || y[j] == b || orient2d_filtered(a, b, y[j], axis) == -turn;
      if (beyond) return true;
    }
    return false;
  };
  return divides(s, t) || divides(t, s);
}

bool segment_meets_triangle(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int sp = orient3d_filtered(a, b, c, p), sq = orient3d_filtered(a, b, c, q);
  if (sp != 2 && sq != 2) {
    if (sp == sq) return false;
    // p and q are strictly on opposite sides (hence abc has an area): the line's side of each edge decides.
    const int s0 = orient3d_filtered(p, q, a, b), s1 = orient3d_filtered(p, q, b, c), s2 = orient3d_filtered(p, q, c, a);
    if ((s0 != 2 && s1 != 2 && s0 != s1) || (s1 != 2 && s2 != 2 && s1 != s2) || (s0 != 2 && s2 != 2 && s0 != s2)) return false;
    if (s0 != 2 && s1 != 2 && s2 != 2) return true;
    const int e0 = orient3d(p, q, a, b), e1 = orient3d(p, q, b, c), e2 = orient3d(p, q, c, a);
    return (e0 >= 0 && e1 >= 0 && e2 >= 0) || (e0 <= 0 && e1 <= 0 && e2 <= 0);
  }
  if (collinear(a, b, c)) {
    const auto [u, v] = as_segment(a, b, c);
    return segments_meet(p, q, u, v);
  }
  const Kernel::Triangle_3 triangle(pt(a), pt(b), pt(c));
  if (same(p, q)) return triangle.has_on(pt(p));
  return CGAL::do_intersect(Kernel::Segment_3(pt(p), pt(q)), triangle);
}

bool triangles_meet(const Vec3 (&s)[3], const Vec3 (&t)[3]) {
  // All of one strictly on one side of the other's plane: apart.
  const auto apart = [](const Vec3(&x)[3], const Vec3(&y)[3]) {
    const int s0 = orient3d_filtered(x[0], x[1], x[2], y[0]);
    return s0 != 2 && orient3d_filtered(x[0], x[1], x[2], y[1]) == s0 && orient3d_filtered(x[0], x[1], x[2], y[2]) == s0;
  };
  if (apart(s, t) || apart(t, s)) return false;
  const bool flat_s = collinear(s[0], s[1], s[2]), flat_t = collinear(t[0], t[1], t[2]);
  if (flat_s) {
    const auto [u, v] = as_segment(s[0], s[1], s[2]);
    return segment_meets_triangle(u, v, t[0], t[1], t[2]);
  }
  if (flat_t) {
    const auto [u, v] = as_segment(t[0], t[1], t[2]);
    return segment_meets_triangle(u, v, s[0], s[1], s[2]);
  }
  return CGAL::do_intersect(Kernel::Triangle_3(pt(s[0]), pt(s[1]), pt(s[2])), Kernel::Triangle_3(pt(t[0]), pt(t[1]), pt(t[2])));
}

int compare_angle(const Vec3& u, const Vec3& v, const Vec3& zero, const Vec3& a, const Vec3& b) {
  // Which quarter of the turn: 0 on the zero half-plane, 1 before half a turn, 2 at half a turn, 3 beyond it.
  const auto quarter = [&](const Vec3& w) {
    const int side = orient3d(u, v, zero, w);
    if (side != 0) return side > 0 ? 1 : 3;
    return coplanar_side(u, v, zero, w) > 0 ? 0 : 2;
  };
  const int qa = quarter(a), qb = quarter(b);
  if (qa != qb) return qa < qb ? -1 : 1;
  if (qa == 0 || qa == 2) return 0;
  return -orient3d(u, v, a, b);
}

}  // namespace geo
