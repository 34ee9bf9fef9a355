#include "contact/detection/simplex.h"

#include <limits>

#include "geometry/distance.h"

namespace geo {
namespace {

// Weights of the corners for the place closest to p.
Vec3 weights_near(const Vec3& p, const Vec3* s, int size) {
  if (size == 1) return {1, 0, 0};
  if (size == 2) {
    const Vec3 d = s[1] - s[0];
    const double length = d.squaredNorm(), t = length > 0 ? std::clamp((p - s[0]).dot(d) / length, 0.0, 1.0) : 0.0;
    return {1 - t, t, 0};
  }
  const Vec3 w = barycentric(closest_point_on_triangle(p, s[0], s[1], s[2]), s[0], s[1], s[2]).cwiseMax(0);
  return w / w.sum();
}

Vec3 place(const Vec3& w, const Vec3* s, int size) {
  Vec3 p = w[0] * s[0];
  for (int k = 1; k < size; ++k) p += w[k] * s[k];
  return p;
}

}  // namespace

ClosestPlaces closest_places(const Vec3* a, int a_size, const Vec3* b, int b_size) {
  ClosestPlaces best;
  double least = std::numeric_limits<double>::infinity();
  const auto offer = [&](const Vec3& from, const Vec3& to) {
    const Vec3 apart = place(from, a, a_size) - place(to, b, b_size);
    if (const double d = apart.squaredNorm(); d < least) least = d, best = {from, to, apart};
  };
  for (int i = 0; i < a_size; ++i) offer(Vec3::Unit(i), weights_near(a[i], b, b_size));
  for (int j = 0; j < b_size; ++j) offer(weights_near(b[j], a, a_size), Vec3::Unit(j));
  const auto edges = [](int size) { return size == 3 ? 3 : size - 1; };
  for (int i = 0; i < edges(a_size); ++i)
    for (int j = 0; j < edges(b_size); ++j) {
      const int i1 = (i + 1) % 3, j1 = (j + 1) % 3;
      const Vec3 u = a[i1] - a[i], v = b[j1] - b[j], w = a[i] - b[j];
      const double uu = u.dot(u), vv = v.dot(v), uv = u.dot(v), det = uu * vv - uv * uv;
      if (!(det > 0)) continue;  // parallel: a corner is as close
      const double s = (uv * v.dot(w) - vv * u.dot(w)) / det, t = (uu * v.dot(w) - uv * u.dot(w)) / det;
      if (!(s > 0 && s < 1 && t > 0 && t < 1)) continue;  // an end is closest: a corner's case
      Vec3 from = Vec3::Zero(), to = Vec3::Zero();
      from[i] = 1 - s, from[i1] = s, to[j] = 1 - t, to[j1] = t;
      offer(from, to);
    }
  return best;
}

}  // namespace geo
