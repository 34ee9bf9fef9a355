// Filtered orientations decide most cases (error bounds: Shewchuk 1997). Triangle pairs follow
// Guigue and Devillers (2003). Orientations that a filter leaves open are signs of expansions
// (geometry/expansion.h); degenerate triangles and numbers out of range go to CGAL's exact kernel.
#include "geometry/predicates.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <cmath>

#include "geometry/coordinate_order.h"
#include "geometry/expansion.h"

namespace geo {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

Point pt(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

bool same(const Vec3& a, const Vec3& b) { return a == b; }

// The segment that a degenerate triangle is: the extreme ones of collinear points a, b, c.
std::pair<Vec3, Vec3> as_segment(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {std::min({a, b, c}, is_before), std::max({a, b, c}, is_before)};
}

bool segments_meet(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  if (same(p, q) && same(r, s)) return same(p, r);
  if (same(p, q)) return Kernel::Segment_3(pt(r), pt(s)).has_on(pt(p));
  if (same(r, s)) return Kernel::Segment_3(pt(p), pt(q)).has_on(pt(r));
  return CGAL::do_intersect(Kernel::Segment_3(pt(p), pt(q)), Kernel::Segment_3(pt(r), pt(s)));
}

// Whether products of three differences of such coordinates are exact as expansions: their last
// bits are at least (2⁻¹⁵⁰ · 2⁻⁵²)³ = 2⁻⁶⁰⁶, their sums below 6 · (2³⁰¹)³.
bool fits_expansions(const Vec3& p) {
  for (int i = 0; i < 3; ++i) {
    const double size = std::abs(p[i]);
    if (size != 0 && !(size > 0x1p-150 && size < 0x1p300)) return false;
  }
  return true;
}

using Difference = Expansion<2>;

int orient2d_by_expansions(const Vec3& a, const Vec3& b, const Vec3& c, int i, int j) {
  const auto left = Difference::difference(a[i], c[i]) * Difference::difference(b[j], c[j]);
  const auto right = Difference::difference(a[j], c[j]) * Difference::difference(b[i], c[i]);
  return (left - right).sign();
}

int orient3d_by_expansions(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Difference u[3], v[3], w[3];
  for (int i = 0; i < 3; ++i) {
    u[i] = Difference::difference(b[i], a[i]);
    v[i] = Difference::difference(c[i], a[i]);
    w[i] = Difference::difference(d[i], a[i]);
  }
  const auto term = [&](int i, int j, int k) { return (u[i] * v[j] - u[j] * v[i]) * w[k]; };
  return (term(0, 1, 2) + term(1, 2, 0) + term(2, 0, 1)).sign();
}

// The orientation in the plane of two coordinates.
int orient_projected(const Vec3& a, const Vec3& b, const Vec3& c, int i, int j) {
  if (fits_expansions(a) && fits_expansions(b) && fits_expansions(c)) return orient2d_by_expansions(a, b, c, i, j);
  return static_cast<int>(
      CGAL::orientation(Kernel::Point_2(a[i], a[j]), Kernel::Point_2(b[i], b[j]), Kernel::Point_2(c[i], c[j])));
}

}  // namespace

int orient3d_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  if (fits_expansions(a) && fits_expansions(b) && fits_expansions(c) && fits_expansions(d))
    return orient3d_by_expansions(a, b, c, d);
  return static_cast<int>(CGAL::orientation(pt(a), pt(b), pt(c), pt(d)));
}

int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int sign = orient2d_filtered(a, b, c, axis), i = (axis + 1) % 3, j = (axis + 2) % 3;
  return sign != 2 ? sign : orient_projected(a, b, c, i, j);
}

std::pair<int, int> projection_axis(const Vec3& a, const Vec3& b, const Vec3& c) {
  int axis = 0;
  (b - a).cross(c - a).cwiseAbs().maxCoeff(&axis);
  int turn = orient2d(a, b, c, axis);
  for (int tries = 0; tries < 2 && turn == 0; ++tries) {
    axis = (axis + 1) % 3;
    turn = orient2d(a, b, c, axis);
  }
  return {axis, turn};
}

bool collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  // Filter: each component of the cross product has a rounding error of at most 4 ε times its
  // permanent, ε = 2⁻⁵³: 4.5e-16, below the 5e-16 used.
  const Vec3 u = b - a, v = c - a;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double x = u[j] * v[k], y = u[k] * v[j], permanent = std::abs(x) + std::abs(y);
    if (permanent > filter_smallest && permanent < filter_largest && std::abs(x - y) > 5e-16 * permanent) return false;
  }
  return orient_projected(a, b, c, 0, 1) == 0 && orient_projected(a, b, c, 1, 2) == 0 &&
         orient_projected(a, b, c, 2, 0) == 0;
}

int coplanar_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  // In a projection in which abc has an area.
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    if (const int turn = orient_projected(a, b, c, i, j); turn != 0) return turn * orient_projected(a, b, d, i, j);
  }
  return 0;
}

bool share_corners_only(const Vec3 (&s)[3], const Vec3 (&t)[3]) {
  int axis = 0;
  (s[1] - s[0]).cross(s[2] - s[0]).cwiseAbs().maxCoeff(&axis);
  // Whether the line through an edge of x has y strictly on its far side, except for shared
  // corners.
  const auto edge_separates = [axis](const Vec3(&x)[3], const Vec3(&y)[3]) {
    const int turn = orient2d_filtered(x[0], x[1], x[2], axis);
    if (turn == 2) return false;
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = x[k], &b = x[(k + 1) % 3];
      bool beyond = true;
      for (int j = 0; j < 3 && beyond; ++j)
        beyond = y[j] == a || y[j] == b || orient2d_filtered(a, b, y[j], axis) == -turn;
      if (beyond) return true;
    }
    return false;
  };
  return edge_separates(s, t) || edge_separates(t, s);
}

bool segment_meets_triangle(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int sp = orient3d_filtered(a, b, c, p), sq = orient3d_filtered(a, b, c, q);
  if (sp != 2 && sq != 2) {
    if (sp == sq) return false;
    // The end points are strictly on opposite sides, hence abc has an area: the orientations of the
    // line and each edge decide.
    const int s0 = orient3d_filtered(p, q, a, b), s1 = orient3d_filtered(p, q, b, c),
              s2 = orient3d_filtered(p, q, c, a);
    if ((s0 != 2 && s1 != 2 && s0 != s1) || (s1 != 2 && s2 != 2 && s1 != s2) || (s0 != 2 && s2 != 2 && s0 != s2))
      return false;
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
  // Disjoint if all corners of one lie strictly on one side of the plane of the other.
  int sign[2][3];
  for (int k = 0; k < 3; ++k) sign[0][k] = orient3d_filtered(s[0], s[1], s[2], t[k]);
  if (sign[0][0] != 2 && sign[0][0] == sign[0][1] && sign[0][0] == sign[0][2]) return false;
  for (int k = 0; k < 3; ++k) sign[1][k] = orient3d_filtered(t[0], t[1], t[2], s[k]);
  if (sign[1][0] != 2 && sign[1][0] == sign[1][1] && sign[1][0] == sign[1][2]) return false;
  bool decided = true;
  for (const auto& row : sign)
    for (const int x : row) decided = decided && x != 2;
  if (decided) {
    // Both meet the line common to their planes: do the two intervals overlap? With the lone
    // corner of each first and on the positive side, two orientations decide (Guigue, Devillers
    // 2003).
    const auto arrange = [](const Vec3(&x)[3], const int(&of)[3], const Vec3*(&corner)[3]) {
      int lone = of[0] == of[1] ? 2 : of[0] == of[2] ? 1 : 0;
      for (int k = 0; k < 3; ++k) corner[k] = &x[(lone + k) % 3];
      return of[lone] > 0;
    };
    const Vec3 *p[3], *q[3];
    const bool up_s = arrange(s, sign[1], p), up_t = arrange(t, sign[0], q);
    if (!up_s) std::swap(q[1], q[2]);
    if (!up_t) std::swap(p[1], p[2]);
    const int first = orient3d_filtered(*p[0], *p[1], *q[0], *q[1]),
              second = orient3d_filtered(*p[0], *p[2], *q[2], *q[0]);
    if (first == 1 || second == 1) return false;
    if (first == -1 && second == -1) return true;
  }
  const bool flat_s = collinear(s[0], s[1], s[2]), flat_t = collinear(t[0], t[1], t[2]);
  if (flat_s) {
    const auto [u, v] = as_segment(s[0], s[1], s[2]);
    return segment_meets_triangle(u, v, t[0], t[1], t[2]);
  }
  if (flat_t) {
    const auto [u, v] = as_segment(t[0], t[1], t[2]);
    return segment_meets_triangle(u, v, s[0], s[1], s[2]);
  }
  return CGAL::do_intersect(Kernel::Triangle_3(pt(s[0]), pt(s[1]), pt(s[2])),
                            Kernel::Triangle_3(pt(t[0]), pt(t[1]), pt(t[2])));
}

int compare_angle(const Vec3& u, const Vec3& v, const Vec3& zero, const Vec3& a, const Vec3& b) {
  // 0: angle 0; 1: in (0, π); 2: π; 3: in (π, 2π).
  const auto sector = [&](const Vec3& w) {
    const int side = orient3d(u, v, zero, w);
    if (side != 0) return side > 0 ? 1 : 3;
    return coplanar_side(u, v, zero, w) > 0 ? 0 : 2;
  };
  const int qa = sector(a), qb = sector(b);
  if (qa != qb) return qa < qb ? -1 : 1;
  if (qa == 0 || qa == 2) return 0;
  return -orient3d(u, v, a, b);
}

int volume_sign(std::span<const std::array<Vec3, 3>> triangles) {
  if (triangles.empty()) return 0;
  // Volumes of tetrahedra with a common apex on the surface, so that coordinates far from 0 do no
  // harm.
  const Vec3 apex = triangles[0][0];
  double sum = 0, permanent = 0;
  for (const auto& corners : triangles) {
    const Vec3 a = corners[0] - apex, b = corners[1] - apex, c = corners[2] - apex;
    sum += a.dot(b.cross(c));
    const Vec3 u = b.cwiseAbs(), v = c.cwiseAbs();
    permanent += a.cwiseAbs().dot(
        Vec3(u.y() * v.z() + u.z() * v.y(), u.z() * v.x() + u.x() * v.z(), u.x() * v.y() + u.y() * v.x()));
  }
  // Rounding, relative to the permanent, with ε = 2⁻⁵³: 3 ε of the differences, 5 ε of a
  // determinant, n ε of the sum, and as much for the permanent's own sum. 2⁻⁵² (n + 8) bounds all
  // of it.
  const double bound = 0x1p-52 * (double(triangles.size()) + 8) * permanent;
  if (permanent > filter_smallest && permanent < filter_largest && std::abs(sum) > bound) return sum > 0 ? 1 : -1;
  using Exact = CGAL::Exact_rational;
  Exact exact = 0;
  const auto minus = [](const Vec3& p, const Vec3& q, int k) { return Exact(p[k]) - Exact(q[k]); };
  for (const auto& corners : triangles) {
    std::array<std::array<Exact, 3>, 3> m;
    for (int row = 0; row < 3; ++row)
      for (int k = 0; k < 3; ++k) m[row][k] = minus(corners[row], apex, k);
    exact += m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) + m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  }
  return static_cast<int>(CGAL::sign(exact));
}

}  // namespace geo
