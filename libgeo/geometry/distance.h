// Closest points, in floating point (distances filter and weigh; they never decide topology).
#pragma once

#include "kerf/vec.h"

namespace geo {

/// The point of triangle abc that is closest to p (Ericson, Real-Time Collision Detection, § 5.1.5), and what it is on:
/// the inside, −1, corner k of abc, k, or the edge from corner k to the next, 3 + k.
struct OnTriangle {
  Vec3 point;
  int feature;
};
OnTriangle closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);
inline Vec3 closest_point_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  return closest_on_triangle(p, a, b, c).point;
}

/// A ball about the middle of a triangle that holds it.
struct Ball {
  Vec3 center;
  double radius;
};
Ball ball_around(const std::array<Vec3, 3>& triangle);

/// The distance between segments pq and rs, either of which may be a point (Ericson, § 5.1.9).
double distance_between_segments(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s);

/// Barycentric coordinates (weights of a, b, c; they sum to 1) of the projection of p onto the plane of abc.
Vec3 barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace geo
