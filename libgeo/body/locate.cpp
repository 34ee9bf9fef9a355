#include "body/locate.h"

#include <algorithm>

#include "base/error.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"

namespace geo {

void triangles_near(const Complex& complex, const Box3& box, std::vector<std::array<Vec3, 3>>& out) {
  std::vector<FaceId> faces;
  complex.near(box, faces);
  for (const FaceId f : faces) out.push_back(complex.corners(f));
}

bool is_blocked(const Complex& complex, const Vec3& p, const Vec3& q, FaceId except) {
  Box3 box{p, p};
  box.add(q);
  std::vector<FaceId> faces;
  complex.near(box, faces);
  return std::any_of(faces.begin(), faces.end(), [&](FaceId f) {
    const auto t = complex.corners(f);
    return f != except && segment_meets_triangle(p, q, t[0], t[1], t[2]);
  });
}

bool stands_before(const Complex& k, Side s, const Vec3& base, const Vec3& p) {
  const auto own = k.corners(s.face);
  return k.has(s) && orient3d(own[0], own[1], own[2], p) == (s.which ? 1 : -1) && !is_blocked(k, base, p, s.face);
}

Side side_seen_from(const Complex& complex, const Vec3& p, double reach) {
  std::vector<FaceId> faces;
  const double everything = 4 * (complex.extent().diagonal() + (p - complex.extent().center()).norm());
  for (double r = reach;; r *= 2) {
    faces.clear();
    complex.near(Box3{p, p}.grown(r), faces);
    if (!faces.empty() || r > everything) break;
  }
  if (faces.empty()) throw GeometryError("the complex has no faces");
  const auto middle = [&](FaceId f) {
    const auto t = complex.corners(f);
    return Vec3((t[0] + t[1] + t[2]) / 3);
  };
  // The nearest middle that nothing hides tells without doubt, unless p is in the face's plane.
  std::vector<std::pair<double, FaceId>> targets;
  for (const FaceId f : faces) targets.push_back({(middle(f) - p).squaredNorm(), f});
  std::sort(targets.begin(), targets.end());
  for (std::size_t i = 0; i < std::min<std::size_t>(targets.size(), 16); ++i) {
    const FaceId f = targets[i].second;
    const auto t = complex.corners(f);
    const int above = orient3d(t[0], t[1], t[2], p);
    if (above != 0 && !is_blocked(complex, p, middle(f), f)) return {f, above > 0 ? 1 : 0};
  }
  // Else what the line to the nearest middle meets first.
  const FaceId target = targets[0].second;
  const Vec3 q = middle(target);
  Box3 box{p, p};
  box.add(q);
  std::vector<FaceId> between;
  complex.near(box, between);
  FaceId first = target;
  double best = 1;
  for (const FaceId f : between) {
    const auto t = complex.corners(f);
    if (f == target || !segment_meets_triangle(p, q, t[0], t[1], t[2])) continue;
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
    const double at = n.dot(t[0] - p), along = n.dot(q - p);
    if (along != 0 && at / along < best) best = at / along, first = f;
  }
  const auto t = complex.corners(first);
  return {first, orient3d(t[0], t[1], t[2], p) > 0 ? 1 : 0};
}

bool is_inside(const Complex& complex, const Vec3& p, double reach) {
  const Side s = side_seen_from(complex, p, reach);
  const auto t = complex.corners(s.face);
  return complex.has(s) && !segment_meets_triangle(p, p, t[0], t[1], t[2]);
}

}  // namespace geo
