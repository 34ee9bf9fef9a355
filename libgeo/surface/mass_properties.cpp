// mass_properties() of kerf/pieces.h. Second moments of a tetrahedron 0pqr of volume V:
// V (p pᵀ + q qᵀ + r rᵀ + s sᵀ) / 20, s = p + q + r (Tonon 2004).
#include "kerf/pieces.h"

namespace geo {

MassProperties mass_properties(const TriangleMesh& mesh) {
  const Vec3 o = bounding_box(mesh).center();
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 p = mesh.vertices[a] - o, q = mesh.vertices[b] - o, r = mesh.vertices[c] - o, s = p + q + r;
    const double v = p.dot(q.cross(r));
    six += v;
    first += v * s / 4;
    second += v / 120 * (p * p.transpose() + q * q.transpose() + r * r.transpose() + s * s.transpose());
  }
  MassProperties result{six / 6, o, Mat3::Zero()};
  if (six > 0) {
    const Vec3 offset = first / six;
    result.centroid = o + offset;
    second -= six / 6 * offset * offset.transpose();
  }
  result.inertia = second.trace() * Mat3::Identity() - second;
  return result;
}

}  // namespace geo
