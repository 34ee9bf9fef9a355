// cot of the smallest angle, opposite to the shortest side a: (b² + c² − a²) / (4 · area), from the
// law of cosines. Deviation: distances from a point of the old surface to the new triangles.
#include "crack/edit_quality.h"

#include <algorithm>
#include <map>

#include "geometry/distance.h"
#include "surface/radial_edge.h"

namespace geo::crack {
namespace {

std::array<Vec3, 3> corners_of(const Complex& k, const ComplexEdit& edit, const ComplexEdit::NewFace& f) {
  std::array<Vec3, 3> t;
  for (int i = 0; i < 3; ++i) t[i] = point_after(k, edit, f.v[i]);
  return t;
}

}  // namespace

double smallest_angle_cotangent(const std::array<Vec3, 3>& t) {
  const double ab = (t[1] - t[0]).squaredNorm(), bc = (t[2] - t[1]).squaredNorm(), ca = (t[0] - t[2]).squaredNorm();
  const double area = (t[1] - t[0]).cross(t[2] - t[0]).norm();
  // The smallest angle is opposite to the shortest side.
  return 0.5 * (ab + bc + ca - 2 * std::min({ab, bc, ca})) / std::max(area, 1e-300);
}

double deviation_at(const Complex& k, const LocalEdit& local, const Vec3& p, const FeatureRules& rules) {
  std::map<std::int32_t, double> nearest;
  for (const auto& f : local.edit.new_faces) {
    if (f.crack == 0 && rules.keep_skin) continue;
    const auto t = corners_of(k, local.edit, f);
    const double d = (closest_point_on_triangle(p, t[0], t[1], t[2]) - p).norm();
    const auto [it, is_new] = nearest.try_emplace(f.crack, d);
    if (!is_new) it->second = std::min(it->second, d);
  }
  double largest = 0;
  for (const auto& [crack, d] : nearest) largest = std::max(largest, d);
  return largest;
}

std::pair<double, double> worst_if_moved(const Complex& k, VertexId v, const Vec3& p, VertexId into) {
  double before = 0, after = 0;
  for (const FaceId f : k.faces_at(v)) {
    auto t = k.corners(f);
    before = std::max(before, smallest_angle_cotangent(t));
    if (into.valid() && corner_at(k.face(f), into) >= 0) continue;
    t[static_cast<std::size_t>(corner_at(k.face(f), v))] = p;
    after = std::max(after, smallest_angle_cotangent(t));
  }
  return {before, after};
}

double worst_removed(const Complex& k, const LocalEdit& local) {
  double worst = 0;
  for (const FaceId f : local.edit.removed_faces) worst = std::max(worst, smallest_angle_cotangent(k.corners(f)));
  return worst;
}

double worst_new(const Complex& k, const LocalEdit& local) {
  double worst = 0;
  for (const auto& f : local.edit.new_faces)
    worst = std::max(worst, smallest_angle_cotangent(corners_of(k, local.edit, f)));
  return worst;
}

}  // namespace geo::crack
