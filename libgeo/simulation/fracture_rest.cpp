#include "simulation/fracture_rest.h"

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
  front.crack = crack, front.step = 1;
  front.closed = line.front() == line.back();
  for (std::size_t k = 0; k < line.size(); ++k) {
    const FrontState::Point p{complex.point(line[k]), line[k]};
    if (k > 0) front.segments.push_back({{complex.point(line[k - 1]), line[k - 1]}, p});
    if (!front.closed || k + 1 < line.size()) front.points.push_back(p);
  }
  return front;
}

// Away from the crack that ends at this edge, as long as the edge.
Vec3 ahead_of(const Complex& complex, VertexId a, VertexId b) {
  const auto ring = complex.around(a, b);
  if (ring.size() != 1) return Vec3::Zero();
  Vec3 behind = Vec3::Zero();
  for (const VertexId v : complex.face(ring[0]).v)
    if (v != a && v != b) behind = complex.point(v);
  const Vec3 along = complex.point(b) - complex.point(a), across = complex.point(a) - behind;
  return along.norm() * (across - across.dot(along) / along.squaredNorm() * along).normalized();
}

}  // namespace

std::vector<FrontState> left_behind(const Complex& complex, std::int32_t crack, const Box3& where,
                                    std::span<const GrowingFront> fronts) {
  std::set<Ends> followed;
  for (const GrowingFront& g : fronts)
    for (const auto& segment : g.front.segments)
      for (std::size_t k = 1; k < segment.size(); ++k) followed.insert(unordered(segment[k - 1].id, segment[k].id));
  // Edges of the border as their faces have them: the crack is on their left, seen against its normal.
  std::vector<FaceId> faces;
  complex.near(where, faces);
  std::map<VertexId, std::vector<VertexId>> next;
  std::map<VertexId, int> come;
  for (const FaceId f : faces) {
    const auto& face = complex.face(f);
    for (std::size_t k = 0; k < 3 && face.crack == crack; ++k) {
      const VertexId a = face.v[k], b = face.v[(k + 1) % 3];
      if (complex.around(a, b).size() == 1 && !followed.contains(unordered(a, b))) next[a].push_back(b), ++come[b];
    }
  }
  std::vector<FrontState> found;
  const auto follow = [&](VertexId from) {
    std::vector<VertexId> line{from};
    do {
      auto& ways = next[line.back()];
      line.push_back(ways.back()), ways.pop_back();
    } while (line.back() != from && next[line.back()].size() == 1 && come[line.back()] == 1);
    found.push_back(front_along(complex, crack, line));
  };
  std::vector<VertexId> starts;
  for (const auto& [v, ways] : next) starts.push_back(v);
  for (const bool ends : {true, false})  // lines first; what is left are loops
    for (const VertexId v : starts)
      while (!next[v].empty() && (!ends || next[v].size() != 1 || come[v] != 1)) follow(v);
  return found;
}

std::vector<Vec3> across_ligament(const Complex& complex, const FrontState& front, double most) {
  const std::size_t n = front.points.size();
  if (front.closed || n < 2) return {};
  Vec3 way = Vec3::Zero();
  for (std::size_t k = 1; k < n; ++k) way += ahead_of(complex, front.points[k - 1].id, front.points[k].id);
  if (!(way.squaredNorm() > 0)) return {};
  way.normalize();
  std::vector<Vec3> next;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3& p = front.points[k].position;
    Vec3 to = p + 1.2 * most * way;
    if (k == 0 || k + 1 == n)
      to += 1.2 * most * (p - front.points[k == 0 ? 1 : n - 2].position).normalized();  // aside, into the air
    const bool end = k == 0 || k + 1 == n;
    if (is_inside(complex, end ? Vec3(p + 1e-3 * (to - p)) : Vec3(p + most * way))) return {};
    next.push_back(to);
  }
  return next;
}

bool is_ligament(const Complex& complex, const TipFrame& tip, double spacing) {
  return is_blocked(complex, tip.at + 1e-4 * spacing * tip.ahead, tip.at + 0.5 * spacing * tip.ahead);
}

}  // namespace geo
