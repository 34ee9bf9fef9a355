// Measures of kerf/mesh.h: box, area, volume. Volume: Σ a · (b × c) / 6 from the middle of the box
// (divergence theorem). Area: Σ |(b − a) × (c − a)| / 2. Both are compensated sums (Neumaier 1974).
#include "kerf/mesh.h"

#include <Eigen/Geometry>

namespace geo {
namespace {

// Neumaier's compensated sum: volumes of pieces are compared with the whole to 1e-12.
class Sum {
 public:
  void add(double x) {
    const double t = sum_ + x;
    rest_ += std::abs(sum_) >= std::abs(x) ? (sum_ - t) + x : (x - t) + sum_;
    sum_ = t;
  }
  double value() const { return sum_ + rest_; }

 private:
  double sum_ = 0, rest_ = 0;
};

}  // namespace

std::vector<std::array<Vec3, 3>> corners_of(const TriangleMesh& mesh) {
  std::vector<std::array<Vec3, 3>> corners;
  corners.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles)
    corners.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
  return corners;
}

Box3 bounding_box(const TriangleMesh& mesh) {
  Box3 box;
  for (const auto& t : mesh.triangles)
    for (const auto v : t) box.add(mesh.vertices[v]);
  return box;
}

double signed_volume(const TriangleMesh& mesh) {
  const Box3 box = bounding_box(mesh);
  if (box.empty()) return 0;
  const Vec3 origin = box.center();
  Sum sum;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 a = mesh.vertices[i] - origin, b = mesh.vertices[j] - origin, c = mesh.vertices[k] - origin;
    sum.add(a.dot(b.cross(c)) / 6);
  }
  return sum.value();
}

double area(const TriangleMesh& mesh) {
  Sum sum;
  for (const auto& [i, j, k] : mesh.triangles)
    sum.add(0.5 * (mesh.vertices[j] - mesh.vertices[i]).cross(mesh.vertices[k] - mesh.vertices[i]).norm());
  return sum.value();
}

}  // namespace geo
