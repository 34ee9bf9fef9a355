// Exact geometric predicates on doubles: a static filter first, CGAL's exact arithmetic where it cannot say.
#pragma once

#include "base/vec.h"

namespace geo {

/// Sign of det(b−a, c−a, d−a): +1 when d lies on the side of abc that its counter-clockwise normal points to,
/// −1 on the other side, 0 when the four points are exactly coplanar.
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The same, or 2 where only exact arithmetic could say.
int orient3d_quick(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Sign of the turn abc in the two axes that follow `axis` (0, 1, 2): counter-clockwise positive.
int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int axis);

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
