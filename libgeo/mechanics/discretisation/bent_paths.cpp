#include "mechanics/discretisation/bent_paths.h"

#include <algorithm>
#include <cmath>

namespace geo {
namespace {

bool before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

// Where the shortest way from p to q meets the segment ab: both unfolded into a plane on either
// side of its line.
Vec3 shortest_by(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double length = along.squaredNorm();
  if (!(length > 0)) return a;
  const double tp = (p - a).dot(along) / length, tq = (q - a).dot(along) / length;
  const double dp = (p - a - tp * along).norm(), dq = (q - a - tq * along).norm();
  const double t = dp + dq > 0 ? (tp * dq + tq * dp) / (dp + dq) : tp;
  return a + std::clamp(t, 0.0, 1.0) * along;
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
      if (before(complex.point(w), complex.point(v))) std::swap(v, w);  // whatever the order of ids is
      const Vec3 &a = complex.point(v), &b = complex.point(w), &c = complex.point(face.v[(k + 2) % 3]);
      const Vec3 along = (b - a).normalized();
      edges.push_back({a, b, (a - c - (a - c).dot(along) * along).normalized()});
    }
  }
  return edges;
}

std::optional<Sight> sight_round(const Vec3& x, const Vec3& node, double reach, std::span<const FrontEdge> edges,
                                 const TriangleBvh& faces) {
  const Vec3 away = x - node;
  const double straight = away.norm(), longest = std::sqrt(std::sqrt(reach / straight)) * straight;
  std::vector<std::pair<double, Vec3>> ways;
  for (const FrontEdge& e : edges) {
    if ((0.5 * (e.a + e.b) - x).norm() >= reach + (e.b - e.a).norm()) continue;  // most of them
    const Vec3 off = reach / 1024 * e.ahead, bend = shortest_by(x, node, e.a + off, e.b + off);
    if (const double length = (bend - x).norm() + (node - bend).norm(); length < longest)
      ways.push_back({length, bend});
  }
  std::sort(ways.begin(), ways.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : before(a.second, b.second);
  });
  for (const auto& [length, bend] : ways) {
    if (faces.blocks(x, bend) || faces.blocks(bend, node)) continue;
    const double ratio = length / straight, stretch = ratio * ratio * ratio * ratio;
    if (!(stretch * straight < reach)) break;
    // To first order it does not matter where the shortest way bends.
    return Sight{node, stretch * straight,
                 4 * stretch / ratio * (x - bend).normalized() - 3 * stretch / straight * away, reach};
  }
  return {};
}

}  // namespace geo
