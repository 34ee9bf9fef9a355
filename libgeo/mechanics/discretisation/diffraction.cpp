// With s = |x − x_j| and L the length of the bent path, d = (L / s)⁴ s and ∂d = 4 (L / s)³ ∂L − 3
// (L / s)⁴ ∂s. The path bends where the line from x to x_j crosses the edge, once both are unfolded
// into one plane about it, or at the nearer end of the edge.
#include "mechanics/discretisation/diffraction.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "kerf/parallel.h"

namespace geo {
namespace {

// Largest gradient of a diffraction distance. As a point and a node come closer behind a front, the
// exact gradient grows without bound, over less material than a quadrature point stands for.
constexpr double steepest = 4;

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

struct Path {
  double length;
  Vec3 bend;
};

// The first path from x to the node whose both segments touch no face; null: none. The first few
// paths are tested alone, since one of them is clear in most cases.
const Path* first_clear(const Vec3& x, const Vec3& node, std::span<const Path> paths, const OccludingFaces& faces) {
  std::vector<Vec3> bends;
  std::vector<const Path*> open;  // their first segments are clear
  std::vector<std::uint8_t> hidden;
  for (std::size_t begin = 0, count = 4; begin < paths.size(); begin += count, count = 32) {
    const auto some = paths.subspan(begin, std::min(count, paths.size() - begin));
    bends.clear();
    open.clear();
    for (const Path& p : some) bends.push_back(p.bend);
    hidden.assign(some.size(), 0);
    faces.blocks(x, bends, hidden.data());
    bends.clear();
    for (std::size_t k = 0; k < some.size(); ++k)
      if (!hidden[k]) {
        bends.push_back(some[k].bend);
        open.push_back(&some[k]);
      }
    hidden.assign(open.size(), 0);
    faces.blocks(node, bends, hidden.data());
    for (std::size_t k = 0; k < open.size(); ++k)
      if (!hidden[k]) return open[k];
  }
  return nullptr;
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

void Occluders::update(const Complex& surface, std::span<const FaceId> ids) {
  parallel_invoke([&] { fronts = front_edges(surface, ids); }, [&] { faces.update(surface, ids); });
}

Occluders all_occluders(const Complex& surface) {
  std::vector<FaceId> ids;
  for (std::uint32_t f = 0; f < surface.face_count(); ++f)
    if (surface.alive(FaceId(f))) ids.push_back(FaceId(f));
  Occluders all;
  all.update(surface, ids);
  return all;
}

double longest_path(double straight, double support) { return std::sqrt(std::sqrt(support / straight)) * straight; }

std::vector<NearFront> fronts_near(const Vec3& x, double reach, std::span<const FrontEdge> edges) {
  std::vector<NearFront> near;
  for (const FrontEdge& e : edges) {
    const Vec3 middle = 0.5 * (e.a + e.b);
    const double length = (e.b - e.a).norm(), distance = (middle - x).norm();
    if (distance < reach + length)
      near.push_back({.edge = &e, .middle = middle, .length = length, .distance = distance});
  }
  return near;
}

std::optional<SupportNode> diffracted_support(const Vec3& x, const Vec3& node, double support,
                                              std::span<const NearFront> fronts, const OccludingFaces& faces) {
  const Vec3 offset = x - node;
  const double straight = offset.norm(), longest = longest_path(straight, support);
  std::vector<Path> paths;
  for (const NearFront& f : fronts) {
    // The path bends within half the edge's length and the margin of its middle.
    const double least = f.distance + (f.middle - node).norm() - f.length - 2 * bend_margin * support;
    if (f.distance >= support + f.length || least >= longest) continue;
    const Vec3 ahead = 0.5 * bend_margin * support * f.edge->ahead,
               bend = bend_point(x, node, f.edge->a + ahead, f.edge->b + ahead);
    if (const double length = (bend - x).norm() + (node - bend).norm(); length < longest)
      paths.push_back({length, bend});
  }
  std::sort(paths.begin(), paths.end(), [](const Path& a, const Path& b) {
    return a.length != b.length ? a.length < b.length : lexicographically_less(a.bend, b.bend);
  });
  const Path* const path = first_clear(x, node, paths, faces);
  if (!path) return {};
  const double ratio = path->length / straight, stretch = ratio * ratio * ratio * ratio;
  if (!(stretch * straight < support)) return {};
  // The bend point of a shortest path is stationary: its own motion does not change the length to
  // first order.
  Vec3 gradient = 4 * stretch / ratio * (x - path->bend).normalized() - 3 * stretch / straight * offset;
  if (const double norm = gradient.norm(); norm > steepest) gradient *= steepest / norm;
  return SupportNode{
      .position = node, .distance = stretch * straight, .distance_gradient = gradient, .support = support};
}

}  // namespace geo
