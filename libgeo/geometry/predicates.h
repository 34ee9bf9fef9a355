// Exact geometric predicates on doubles: a static filter first, CGAL's exact arithmetic where it cannot say.
#pragma once

#include <cmath>
#include <utility>

#include "kerf/vec.h"

namespace geo {

/// Outside of these a product of three differences may underflow or overflow, and error bounds no longer hold.
constexpr double filter_smallest = 1e-270, filter_largest = 1e300;

/// orient3d(), or 2 where only exact arithmetic could say. The bound is Shewchuk's (1997) A-stage, (7 + 56 ε) ε with
/// ε = 2⁻⁵³, times the permanent.
[[gnu::always_inline]] inline int orient3d_quick(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double adx = a.x() - d.x(), ady = a.y() - d.y(), adz = a.z() - d.z();
  const double bdx = b.x() - d.x(), bdy = b.y() - d.y(), bdz = b.z() - d.z();
  const double cdx = c.x() - d.x(), cdy = c.y() - d.y(), cdz = c.z() - d.z();
  const double bc = bdx * cdy, cb = cdx * bdy, ca = cdx * ady, ac = adx * cdy, ab = adx * bdy, ba = bdx * ady;
  const double det = adz * (bc - cb) + bdz * (ca - ac) + cdz * (ab - ba);
  const double permanent = (std::abs(bc) + std::abs(cb)) * std::abs(adz) +
                           (std::abs(ca) + std::abs(ac)) * std::abs(bdz) +
                           (std::abs(ab) + std::abs(ba)) * std::abs(cdz);
  const double bound = 7.771561172376103e-16 * permanent;
  if (!(permanent > filter_smallest && permanent < filter_largest)) return 2;
  // Shewchuk's determinant is positive when d is below abc; ours the other way round.
  return det > bound ? -1 : det < -bound ? 1 : 2;
}

/// orient2d(), or 2 where only exact arithmetic could say. Shewchuk's A-stage: (3 + 16 ε) ε.
inline int orient2d_quick(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int i = axis == 2 ? 0 : axis + 1, j = axis == 0 ? 2 : axis - 1;
  const double left = (a[i] - c[i]) * (b[j] - c[j]), right = (a[j] - c[j]) * (b[i] - c[i]);
  const double value = left - right, terms = std::abs(left) + std::abs(right), bound = 3.3306690738754716e-16 * terms;
  if (!(terms > filter_smallest && terms < filter_largest)) return 2;
  return value > bound ? 1 : value < -bound ? -1 : 2;
}

/// orient3d() by exact arithmetic.
int orient3d_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Sign of det(b−a, c−a, d−a): +1 when d lies on the side of abc that its counter-clockwise normal points to,
/// −1 on the other side, 0 when the four points are exactly coplanar.
inline int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const int sign = orient3d_quick(a, b, c, d);
  return sign != 2 ? sign : orient3d_exact(a, b, c, d);
}

/// Sign of the turn abc in the two axes that follow `axis` (0, 1, 2): counter-clockwise positive.
int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int axis);

/// The axis against which a triangle is best seen, and its turn then (±1; 0 when it has no area).
std::pair<int, int> view_axis(const Vec3& a, const Vec3& b, const Vec3& c);

/// True when a, b, c lie exactly on one line (coincident points included).
bool collinear(const Vec3& a, const Vec3& b, const Vec3& c);

/// For coplanar a, b, c, d with a, b, c not collinear: +1 when c and d are on the same side of line ab, −1 when on
/// opposite sides, 0 when d is on the line.
int coplanar_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// True when the triangles, seen along the axis that s faces most, are clearly apart but for corners at one place: then
/// they have nothing else in common. False says nothing.
bool share_corners_only(const Vec3 (&s)[3], const Vec3 (&t)[3]);

/// Closed segment against closed triangle, exactly: touching counts. Degenerate segments and triangles are allowed.
bool segment_meets_triangle(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c);

/// Closed triangle against closed triangle, exactly: touching counts.
bool triangles_meet(const Vec3 (&s)[3], const Vec3 (&t)[3]);

/// Compares the angles of half-planes around the directed line u→v. All half-planes are bounded by the line and pass
/// through the given points, which must not be on it. Returns the sign of angle(a) − angle(b), both measured
/// counter-clockwise (seen with v towards the eye) from the half-plane of `zero`, in [0, 2π).
int compare_angle(const Vec3& u, const Vec3& v, const Vec3& zero, const Vec3& a, const Vec3& b);

}  // namespace geo
