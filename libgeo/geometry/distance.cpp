// Closest features by Voronoi regions and by clamped line parameters (Ericson 2005, § 5.1).
#include "geometry/distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace geo {

ClosestOnTriangle closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  // Seven Voronoi regions: three corners, three edges, the interior. Their names follow Ericson.
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {a, 0};
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {b, 1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + (d1 > d3 ? d1 / (d1 - d3) : 0.0) * ab, 3};
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {c, 2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + (d2 > d6 ? d2 / (d2 - d6) : 0.0) * ac, 5};
  const double va = d3 * d6 - d5 * d4;
  const double e = (d4 - d3) + (d5 - d6);
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return {b + (e > 0 ? (d4 - d3) / e : 0.0) * (c - b), 4};
  const double sum = va + vb + vc;
  if (!(sum > 0)) return {a, 0};
  return {a + ab * (vb / sum) + ac * (vc / sum), -1};
}

Ball bounding_ball(const std::array<Vec3, 3>& t) {
  const Vec3 centroid = (t[0] + t[1] + t[2]) / 3;
  return {centroid, std::sqrt(std::max({(t[0] - centroid).squaredNorm(), (t[1] - centroid).squaredNorm(),
                                        (t[2] - centroid).squaredNorm()}))};
}

double height_of(const std::array<Vec3, 3>& t) {
  const double longest = std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
  return longest > 0 ? (t[1] - t[0]).cross(t[2] - t[0]).norm() / longest : 0;
}

double distance_between_segments(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  const Vec3 u = q - p, v = s - r, w = p - r;
  const double uu = u.dot(u), vv = v.dot(v), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const auto ratio = [](double up, double down) { return down > 0 ? std::clamp(up / down, 0.0, 1.0) : 0.0; };
  // The closest parameter of the two lines in closed form, clamped to the first segment. Then two
  // projections: on the second segment, and back on the first.
  const double first = ratio(uv * vw - uw * vv, uu * vv - uv * uv);
  const double second = ratio(vw + first * uv, vv);
  const double again = ratio(second * uv - uw, uu);
  return (w + again * u - second * v).norm();
}

Vec3 barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double bb = ab.dot(ab), bc = ab.dot(ac), cc = ac.dot(ac), pb = ap.dot(ab), pc = ap.dot(ac);
  const double det = bb * cc - bc * bc;
  if (!(det > 0)) return {1, 0, 0};
  const double v = (cc * pb - bc * pc) / det, w = (bb * pc - bc * pb) / det;
  return {1 - v - w, v, w};
}

}  // namespace geo
