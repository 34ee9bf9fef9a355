#include "crack/sweep.h"

#include <algorithm>

#include "crack/index_map.h"
#include "crack/points.h"
#include "geometry/predicates.h"

namespace geo {
namespace {

struct PlaceHash {
  std::size_t operator()(const Vec3& p) const { return crack::hash_of(p); }
};
using Places = crack::Lookup<Vec3, PlaceHash>;  // rows of points by where they are

class Builder {
 public:
  Strip strip;

  std::uint32_t point(const Vec3& p, bool carried) {
    std::uint32_t& row = rows_[p];
    if (row == ~0u)
      row = static_cast<std::uint32_t>(strip.points.size()), strip.points.push_back(p), strip.carried.push_back(false);
    if (carried) strip.carried[row] = true;
    return row;
  }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::array<int, 3> segment) {
    if (a == b || b == c || c == a || collinear(strip.points[a], strip.points[b], strip.points[c])) return;
    strip.triangles.push_back({{a, b, c}, segment});
  }

 private:
  Places rows_;
};

}  // namespace

Strip sweep(const FrontState& front, std::span<const Vec3> next) {
  Builder builder;
  builder.strip.next.assign(next.begin(), next.end());
  for (const auto& segment : front.segments)
    for (const auto& p : segment) builder.point(p.position, true);
  for (std::size_t i = 0; i < front.segments.size(); ++i) {
    std::vector<std::uint32_t> old;
    for (const auto& p : front.segments[i]) {
      const auto row = builder.point(p.position, true);
      if (old.empty() || old.back() != row) old.push_back(row);
    }
    const auto p = builder.point(next[i], false), q = builder.point(next[(i + 1) % next.size()], false);
    const int s = static_cast<int>(i);
    const bool stands_p = old.front() == p, stands_q = old.back() == q;
    if (stands_p && stands_q) continue;
    if (stands_p) {
      // A fan around q; its first side is the new front.
      for (std::size_t k = 0; k + 1 < old.size(); ++k)
        builder.triangle(old[k], old[k + 1], q, {-1, -1, k == 0 ? s : -1});
      continue;
    }
    // A fan around p, closed by the triangle that holds the new front (nothing when q stands still:
    // the fan's last side).
    for (std::size_t k = 0; k + 1 < old.size(); ++k)
      builder.triangle(old[k], old[k + 1], p, {-1, stands_q && k + 2 == old.size() ? s : -1, -1});
    if (!stands_q) builder.triangle(old.back(), q, p, {-1, s, -1});
  }
  return std::move(builder.strip);
}

Strip strip_of(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  Builder builder;
  std::vector<std::uint32_t> row;
  for (const Vec3& p : points) row.push_back(builder.point(p, false));
  for (const auto& t : triangles) builder.triangle(row[t[0]], row[t[1]], row[t[2]], {-1, -1, -1});
  return std::move(builder.strip);
}

void find_near(Strip& strip, const Complex& complex, double reach) {
  strip.near.clear();
  strip.near_begin.assign(1, 0);
  const Box3 extent = complex.extent().grown(reach);
  for (const auto& t : strip.triangles) {
    if (box_of(strip.points[t.p[0]], strip.points[t.p[1]], strip.points[t.p[2]]).meets(extent))
      complex.faces_near_triangle(strip.points[t.p[0]], strip.points[t.p[1]], strip.points[t.p[2]], reach, strip.near);
    strip.near_begin.push_back(static_cast<std::uint32_t>(strip.near.size()));
  }
}

std::size_t snap_to_vertices(Strip& strip, const Complex& complex, double reach) {
  find_near(strip, complex, reach);
  if (strip.triangles.empty()) return 0;
  // Vertices within reach of a triangle's plane; few are.
  std::vector<VertexId> vertices;
  for (std::size_t t = 0; t < strip.triangles.size(); ++t) {
    const auto& tri = strip.triangles[t].p;
    const Vec3 &p0 = strip.points[tri[0]], n = (strip.points[tri[1]] - p0).cross(strip.points[tri[2]] - p0);
    const double limit = 2 * reach * n.norm();
    const Box3 box = box_of(p0, strip.points[tri[1]], strip.points[tri[2]]).grown(reach);
    for (auto f = strip.near_begin[t]; f < strip.near_begin[t + 1]; ++f)
      for (const VertexId v : complex.face(strip.near[f]).v) {
        const Vec3& q = complex.point(v);
        if (std::abs(n.dot(q - p0)) <= limit && Box3{q, q}.meets(box)) vertices.push_back(v);
      }
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  Places known;
  for (const Vec3& p : strip.points) known[p] = 0;
  std::size_t count = 0;
  const double reach2 = reach * reach;
  for (const VertexId v : vertices) {
    const Vec3 q = complex.point(v);
    if (known.find(q) != ~0u) continue;
    // A corner within reach moves to the vertex, if it is free to.
    bool done = false;
    for (std::uint32_t i = 0; i < strip.points.size() && !done; ++i) {
      if ((strip.points[i] - q).squaredNorm() > reach2) continue;
      done = true;
      if (strip.carried[i]) break;
      for (auto& n : strip.next)
        if (n == strip.points[i]) n = q;
      strip.points[i] = q;
      strip.carried[i] = true;
      known[q] = 0;
      ++count;
    }
    if (done) continue;
    const auto add_point = [&] {
      strip.points.push_back(q);
      strip.carried.push_back(true);
      known[q] = 0;
      ++count;
      return static_cast<std::uint32_t>(strip.points.size() - 1);
    };
    // An edge that passes within reach is divided there, in every triangle that has it.
    const std::size_t triangles = strip.triangles.size();
    std::uint32_t a = 0, b = 0;
    for (std::size_t t = 0; t < triangles && !done; ++t)
      for (int k = 0; k < 3 && !done; ++k) {
        a = strip.triangles[t].p[k], b = strip.triangles[t].p[(k + 1) % 3];
        const Vec3 e = strip.points[b] - strip.points[a], w = q - strip.points[a];
        const double along = e.dot(w), length = e.squaredNorm();
        done = along > 0 && along < length && e.cross(w).squaredNorm() <= reach2 * length;
      }
    if (done) {
      const auto row = add_point();
      for (std::size_t t = 0; t < triangles; ++t)
        for (int k = 0; k < 3; ++k) {
          auto& tri = strip.triangles[t];
          const auto u = tri.p[k], w = tri.p[(k + 1) % 3];
          if (!((u == a && w == b) || (u == b && w == a))) continue;
          Strip::Triangle half = tri;  // keeps p[k+1]; the original keeps p[k]
          half.p[k] = row;
          half.segment[(k + 2) % 3] = -1;
          tri.p[(k + 1) % 3] = row;
          tri.segment[(k + 1) % 3] = -1;
          strip.triangles.push_back(half);
          break;
        }
      continue;
    }
    for (std::size_t t = 0; t < triangles && !done; ++t) {
      const auto tri = strip.triangles[t];
      const Vec3 &p0 = strip.points[tri.p[0]], &p1 = strip.points[tri.p[1]], &p2 = strip.points[tri.p[2]];
      const Vec3 n = (p1 - p0).cross(p2 - p0);
      if (std::abs(n.dot(q - p0)) > reach * n.norm()) continue;
      if ((p1 - p0).cross(q - p0).dot(n) <= 0 || (p2 - p1).cross(q - p1).dot(n) <= 0 ||
          (p0 - p2).cross(q - p2).dot(n) <= 0)
        continue;
      const auto row = add_point();
      for (int k = 0; k < 3; ++k) {
        const Strip::Triangle part{{tri.p[k], tri.p[(k + 1) % 3], row}, {tri.segment[k], -1, -1}};
        if (k == 0)
          strip.triangles[t] = part;
        else
          strip.triangles.push_back(part);
      }
      done = true;
    }
  }
  if (count > 0) {
    std::erase_if(strip.triangles, [&](const Strip::Triangle& t) {
      return collinear(strip.points[t.p[0]], strip.points[t.p[1]], strip.points[t.p[2]]);
    });
    find_near(strip, complex, reach);
  }
  return count;
}

}  // namespace geo
