// Exact geometric predicates on doubles. A floating-point filter decides most cases; exact
// arithmetic decides the rest (geometry/exact_predicates.h).
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "kerf/vec.h"

namespace geo {

/// The range of permanents in which the error bounds of filters hold. Beyond it, a product of three
/// differences may underflow or overflow.
constexpr double filter_smallest = 1e-270, filter_largest = 1e300;

/// Error bounds of filters, relative to the permanent: Shewchuk's (1997) A-stage bounds with
/// ε = 2⁻⁵³, (7 + 56 ε) ε for orient3d and (3 + 16 ε) ε for orient2d.
constexpr double orient3d_error = 7.771561172376103e-16, orient2d_error = 3.3306690738754716e-16;

/// orient3d() if the filter decides it, else 2.
[[gnu::always_inline]] inline int orient3d_filtered(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double adx = a.x() - d.x(), ady = a.y() - d.y(), adz = a.z() - d.z();
  const double bdx = b.x() - d.x(), bdy = b.y() - d.y(), bdz = b.z() - d.z();
  const double cdx = c.x() - d.x(), cdy = c.y() - d.y(), cdz = c.z() - d.z();
  const double bc = bdx * cdy, cb = cdx * bdy, ca = cdx * ady, ac = adx * cdy, ab = adx * bdy, ba = bdx * ady;
  const double det = adz * (bc - cb) + bdz * (ca - ac) + cdz * (ab - ba);
  const double permanent = (std::abs(bc) + std::abs(cb)) * std::abs(adz) +
                           (std::abs(ca) + std::abs(ac)) * std::abs(bdz) +
                           (std::abs(ab) + std::abs(ba)) * std::abs(cdz);
  const double bound = orient3d_error * permanent;
  if (!(permanent > filter_smallest && permanent < filter_largest)) return 2;
  // Shewchuk's determinant is positive if d is below abc; orient3d() has the opposite sign.
  return det > bound ? -1 : det < -bound ? 1 : 2;
}

/// orient2d() if the filter decides it, else 2.
inline int orient2d_filtered(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int i = axis == 2 ? 0 : axis + 1, j = axis == 0 ? 2 : axis - 1;
  const double left = (a[i] - c[i]) * (b[j] - c[j]), right = (a[j] - c[j]) * (b[i] - c[i]);
  const double det = left - right, permanent = std::abs(left) + std::abs(right), bound = orient2d_error * permanent;
  if (!(permanent > filter_smallest && permanent < filter_largest)) return 2;
  return det > bound ? 1 : det < -bound ? -1 : 2;
}

/// orient3d() in about a hundred bits, and where a coordinate or a point occurs twice; else 2.
int orient3d_refined(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// orient3d() without a filter of its own.
int orient3d_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The sign of det(b − a, c − a, d − a): +1 if d lies on the side of plane abc that the
/// counter-clockwise normal points to, −1 on the other side, 0 if the points are coplanar.
inline int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const int sign = orient3d_filtered(a, b, c, d);
  return sign != 2 ? sign : orient3d_exact(a, b, c, d);
}

/// The orientation of triangle abc in its projection along coordinate axis `axis` (0, 1 or 2):
/// +1 counter-clockwise, −1 clockwise, 0 collinear.
int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int axis);

/// The coordinate axis along which triangle abc has the largest projection, and orient2d() along it
/// (0 if the triangle has no area).
std::pair<int, int> projection_axis(const Vec3& a, const Vec3& b, const Vec3& c);

/// Whether a, b and c lie on one line; coincident points do.
bool collinear(const Vec3& a, const Vec3& b, const Vec3& c);

/// For coplanar points, a, b, c not collinear: +1 if c and d lie on the same side of line ab, −1 if
/// on opposite sides, 0 if d lies on the line.
int coplanar_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// A filter for pairs of triangles with coincident corners. True only if the triangles have nothing
/// in common but these corners: a line through an edge separates them in the projection along the
/// dominant axis of the normal of s. False is inconclusive.
bool share_corners_only(const Vec3 (&s)[3], const Vec3 (&t)[3]);

/// Whether the closed segment pq meets the closed triangle abc; touching counts. Both may be
/// degenerate.
bool segment_meets_triangle(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c);

/// Whether two closed triangles meet; touching counts. Both may be degenerate.
bool triangles_meet(const Vec3 (&s)[3], const Vec3 (&t)[3]);

/// Compares the angles of two half-planes about the directed line u → v. Half-planes are given by
/// points that are not on the line. Angles are in [0, 2π), counter-clockwise with v towards the
/// viewer, from the half-plane of `zero`. Returns the sign of angle(a) − angle(b).
int compare_angle(const Vec3& u, const Vec3& v, const Vec3& zero, const Vec3& a, const Vec3& b);

/// The sign of the volume that a closed oriented surface encloses, by the divergence theorem: +1
/// where it is oriented outwards. A filter decides nearly always; else rational arithmetic does.
int volume_sign(std::span<const std::array<Vec3, 3>> triangles);

}  // namespace geo
