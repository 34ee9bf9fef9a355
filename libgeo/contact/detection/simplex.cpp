// Closest points by cases: each corner against the other simplex, and each pair of edges, whose
// parameters solve the 2 × 2 normal equations of |a(s) − b(t)|² (Ericson 2005, § 5.1).
#include "contact/detection/simplex.h"

#include <limits>

#include "geometry/distance.h"

namespace geo {
namespace {

// Barycentric coordinates of the point of simplex s that is closest to p.
Vec3 closest_weights(const Vec3& p, const Vec3* s, int size) {
  if (size == 1) return {1, 0, 0};
  if (size == 2) {
    const Vec3 d = s[1] - s[0];
    const double length = d.squaredNorm(), t = length > 0 ? std::clamp((p - s[0]).dot(d) / length, 0.0, 1.0) : 0.0;
    return {1 - t, t, 0};
  }
  const Vec3 w = barycentric(closest_point_on_triangle(p, s[0], s[1], s[2]), s[0], s[1], s[2]).cwiseMax(0);
  return w / w.sum();
}

Vec3 point_of(const Vec3& w, const Vec3* s, int size) {
  Vec3 p = w[0] * s[0];
  for (int k = 1; k < size; ++k) p += w[k] * s[k];
  return p;
}

}  // namespace

ClosestPoints closest_points(const Vec3* a, int a_size, const Vec3* b, int b_size) {
  ClosestPoints best;
  double least = std::numeric_limits<double>::infinity();
  const auto offer = [&](const Vec3& weights_a, const Vec3& weights_b) {
    const Vec3 difference = point_of(weights_a, a, a_size) - point_of(weights_b, b, b_size);
    if (const double d = difference.squaredNorm(); d < least) {
      least = d;
      best = {weights_a, weights_b, difference};
    }
  };
  for (int i = 0; i < a_size; ++i) offer(Vec3::Unit(i), closest_weights(a[i], b, b_size));
  for (int j = 0; j < b_size; ++j) offer(closest_weights(b[j], a, a_size), Vec3::Unit(j));
  const auto edges = [](int size) { return size == 3 ? 3 : size - 1; };
  for (int i = 0; i < edges(a_size); ++i)
    for (int j = 0; j < edges(b_size); ++j) {
      const int i1 = (i + 1) % 3, j1 = (j + 1) % 3;
      const Vec3 u = a[i1] - a[i], v = b[j1] - b[j], w = a[i] - b[j];
      const double uu = u.dot(u), vv = v.dot(v), uv = u.dot(v), det = uu * vv - uv * uv;
      if (!(det > 0)) continue;  // parallel edges: a corner is as close
      const double s = (uv * v.dot(w) - vv * u.dot(w)) / det, t = (uu * v.dot(w) - uv * u.dot(w)) / det;
      if (!(s > 0 && s < 1 && t > 0 && t < 1)) continue;  // an end of an edge is closest: covered by the corners
      Vec3 weights_a = Vec3::Zero(), weights_b = Vec3::Zero();
      weights_a[i] = 1 - s;
      weights_a[i1] = s;
      weights_b[j] = 1 - t;
      weights_b[j1] = t;
      offer(weights_a, weights_b);
    }
  return best;
}

int disjoint_subsimplices(const Triangle& s, const Triangle& t, std::pair<Simplex, Simplex> (&pairs)[2]) {
  Simplex s_own{{}, 0}, t_own{{}, 0};
  for (int k = 0; k < 3; ++k) {
    if (s[k] != t[0] && s[k] != t[1] && s[k] != t[2]) s_own.v[s_own.size++] = s[k];
    if (t[k] != s[0] && t[k] != s[1] && t[k] != s[2]) t_own.v[t_own.size++] = t[k];
  }
  if (s_own.size == 0 || t_own.size == 0) return 0;
  const Simplex s_all{{s[0], s[1], s[2]}, 3}, t_all{{t[0], t[1], t[2]}, 3};
  pairs[0] = {s_own, t_all};
  pairs[1] = {s_all, t_own};
  return s_own.size == 3 ? 1 : 2;
}

}  // namespace geo
