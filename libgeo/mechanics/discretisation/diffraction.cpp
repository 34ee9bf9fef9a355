// With s = |x − x_j| and L the length of the bent path, d = (L / s)⁴ s and ∂d = 4 (L / s)³ ∂L − 3
// (L / s)⁴ ∂s. The path bends where the line from x to x_j crosses the edge, once both are unfolded
// into one plane about it, or at the nearer end of the edge.
#include "mechanics/discretisation/diffraction.h"

#include <algorithm>
#include <cmath>

namespace geo {
namespace {

bool lexicographically_less(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

// The point of segment ab on the shortest path from p to q that touches it: p and q unfolded into a
// plane, on either side of the segment's line.
Vec3 bend_point(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  const Vec3 edge = b - a;
  const double squared_length = edge.squaredNorm();
  if (!(squared_length > 0)) return a;
  const double tp = (p - a).dot(edge) / squared_length, tq = (q - a).dot(edge) / squared_length;
  const double dp = (p - a - tp * edge).norm(), dq = (q - a - tq * edge).norm();
  const double t = dp + dq > 0 ? (tp * dq + tq * dp) / (dp + dq) : tp;
  return a + std::clamp(t, 0.0, 1.0) * edge;
}

}  // namespace

std::vector<FrontEdge> front_edges(const Complex& complex, std::span<const FaceId> faces) {
  std::vector<FrontEdge> edges;
  for (const FaceId f : faces) {
    const auto& face = complex.face(f);
    if (!face.alive || face.crack == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      VertexId v = face.v[k], w = face.v[(k + 1) % 3];
      if (complex.faces_around(v, w).size() != 1) continue;
      // The order of ends depends on their coordinates alone, not on ids.
      if (lexicographically_less(complex.point(w), complex.point(v))) std::swap(v, w);
      const Vec3 &a = complex.point(v), &b = complex.point(w), &c = complex.point(face.v[(k + 2) % 3]);
      const Vec3 direction = (b - a).normalized();
      edges.push_back({a, b, (a - c - (a - c).dot(direction) * direction).normalized()});
    }
  }
  return edges;
}

std::optional<SupportNode> diffracted_support(const Vec3& x, const Vec3& node, double support,
                                              std::span<const FrontEdge> edges, const TriangleBvh& faces) {
  const Vec3 offset = x - node;
  const double straight = offset.norm(), longest = std::sqrt(std::sqrt(support / straight)) * straight;
  struct Path {
    double length;
    Vec3 bend;
  };
  std::vector<Path> paths;
  for (const FrontEdge& e : edges) {
    if ((0.5 * (e.a + e.b) - x).norm() >= support + (e.b - e.a).norm()) continue;  // rejects most edges
    const Vec3 ahead = support / 1024 * e.ahead, bend = bend_point(x, node, e.a + ahead, e.b + ahead);
    if (const double length = (bend - x).norm() + (node - bend).norm(); length < longest)
      paths.push_back({length, bend});
  }
  std::sort(paths.begin(), paths.end(), [](const Path& a, const Path& b) {
    return a.length != b.length ? a.length < b.length : lexicographically_less(a.bend, b.bend);
  });
  for (const auto& [length, bend] : paths) {
    if (faces.blocks(x, bend) || faces.blocks(bend, node)) continue;
    const double ratio = length / straight, stretch = ratio * ratio * ratio * ratio;
    if (!(stretch * straight < support)) break;
    // The bend point of a shortest path is stationary: its own motion does not change the length to
    // first order.
    return SupportNode{node, stretch * straight,
                       4 * stretch / ratio * (x - bend).normalized() - 3 * stretch / straight * offset, support};
  }
  return {};
}

}  // namespace geo
