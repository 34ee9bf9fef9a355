// Closest points and distances, in floating point: they filter and weigh, and never decide
// topology.
#pragma once

#include "kerf/vec.h"

namespace geo {

/// The point of a triangle that is closest to another point, and the feature that it lies on.
struct ClosestOnTriangle {
  Vec3 point;
  int feature;  ///< −1: the interior; k < 3: corner k; 3 + k: the edge from corner k to corner (k + 1) mod 3
};
/// The point of triangle abc closest to p (Ericson, Real-Time Collision Detection, § 5.1.5).
ClosestOnTriangle closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);
/// As closest_on_triangle(), the point alone.
inline Vec3 closest_point_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  return closest_on_triangle(p, a, b, c).point;
}

/// A ball.
struct Ball {
  Vec3 center;
  double radius;
};
/// The smallest ball about the centroid of a triangle that contains it.
Ball bounding_ball(const std::array<Vec3, 3>& triangle);

/// The height of a triangle over its longest side; 0 for one point.
double height_of(const std::array<Vec3, 3>& triangle);

/// The distance between segments pq and rs, either of which may be a point (Ericson, § 5.1.9).
double distance_between_segments(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s);

/// Barycentric coordinates (weights of a, b, c with sum 1) of the projection of p onto the plane of
/// abc. (1, 0, 0) if the triangle has no area.
Vec3 barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace geo
