// Borders of a crack are its edges with a single face. They are traced into open lines, then loops,
// and cut straight ahead, with both ends splayed into the air.
#include "simulation/fracture_ligaments.h"

#include <algorithm>
#include <map>
#include <set>

#include "body/locate.h"

namespace geo {
namespace {

using Ends = std::pair<VertexId, VertexId>;

Ends unordered(VertexId a, VertexId b) { return a < b ? Ends{a, b} : Ends{b, a}; }

FrontState front_along(const Complex& complex, std::int32_t crack, const std::vector<VertexId>& line) {
  FrontState front;
  front.crack = crack;
  front.has_moved = true;
  front.step = 1;
  front.closed = line.front() == line.back();
  for (std::size_t k = 0; k < line.size(); ++k) {
    const FrontState::Point p{complex.point(line[k]), line[k]};
    if (k > 0) front.segments.push_back({{complex.point(line[k - 1]), line[k - 1]}, p});
    if (!front.closed || k + 1 < line.size()) front.points.push_back(p);
  }
  return front;
}

// Direction of growth at an edge where a crack ends, as long as the edge; zero at any other edge.
Vec3 ahead_of(const Complex& complex, VertexId a, VertexId b) {
  const auto ring = complex.faces_around(a, b);
  if (ring.size() != 1) return Vec3::Zero();
  Vec3 behind = Vec3::Zero();
  for (const VertexId v : complex.face(ring[0]).v)
    if (v != a && v != b) behind = complex.point(v);
  const Vec3 along = complex.point(b) - complex.point(a), across = complex.point(a) - behind;
  return along.norm() * (across - across.dot(along) / along.squaredNorm() * along).normalized();
}

}  // namespace

std::vector<FrontState> unfollowed_borders(const Complex& complex, std::int32_t crack, const Box3& where,
                                           std::span<const GrowingFront> fronts) {
  std::set<Ends> followed;
  for (const GrowingFront& g : fronts)
    for (const auto& segment : g.front.segments)
      for (std::size_t k = 1; k < segment.size(); ++k) followed.insert(unordered(segment[k - 1].id, segment[k].id));
  // Border edges in the direction of their faces: the crack is on their left, seen against its
  // normal.
  std::vector<FaceId> faces;
  complex.faces_near(where, faces);
  std::map<VertexId, std::vector<VertexId>> next;
  std::map<VertexId, int> arriving;
  for (const FaceId f : faces) {
    const auto& face = complex.face(f);
    for (std::size_t k = 0; k < 3 && face.crack == crack; ++k) {
      const VertexId a = face.v[k], b = face.v[(k + 1) % 3];
      if (complex.faces_around(a, b).size() == 1 && !followed.contains(unordered(a, b))) {
        next[a].push_back(b);
        ++arriving[b];
      }
    }
  }
  std::vector<FrontState> found;
  const auto trace = [&](VertexId from) {
    std::vector<VertexId> line{from};
    do {
      auto& onward = next[line.back()];
      line.push_back(onward.back());
      onward.pop_back();
    } while (line.back() != from && next[line.back()].size() == 1 && arriving[line.back()] == 1);
    found.push_back(front_along(complex, crack, line));
  };
  std::vector<VertexId> starts;
  for (const auto& [v, onward] : next) starts.push_back(v);
  for (const bool ends : {true, false})  // open lines first, then loops
    for (const VertexId v : starts)
      while (!next[v].empty() && (!ends || next[v].size() != 1 || arriving[v] != 1)) trace(v);
  return found;
}

std::vector<Vec3> across_ligament(const Complex& complex, const FrontState& front, double thickness) {
  const std::size_t n = front.points.size();
  if (front.closed || n < 2) return {};
  Vec3 ahead = Vec3::Zero();
  for (std::size_t k = 1; k < n; ++k) ahead += ahead_of(complex, front.points[k - 1].id, front.points[k].id);
  if (!(ahead.squaredNorm() > 0)) return {};
  ahead.normalize();
  // A fifth more than the thickness, so that the cut passes through the far side.
  std::vector<Vec3> next;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3& p = front.points[k].position;
    Vec3 to = p + 1.2 * thickness * ahead;
    if (k == 0 || k + 1 == n)
      to += 1.2 * thickness * (p - front.points[k == 0 ? 1 : n - 2].position).normalized();  // sideways, into the air
    const bool end = k == 0 || k + 1 == n;
    if (is_inside(complex, end ? Vec3(p + 1e-3 * (to - p)) : Vec3(p + thickness * ahead))) return {};
    next.push_back(to);
  }
  return next;
}

// The segment starts 1e-4 spacings ahead, since the point itself lies on crack faces.
bool is_ligament(const Complex& complex, const TipFrame& tip, double spacing) {
  return is_blocked(complex, tip.at + 1e-4 * spacing * tip.ahead, tip.at + 0.5 * spacing * tip.ahead);
}

}  // namespace geo
