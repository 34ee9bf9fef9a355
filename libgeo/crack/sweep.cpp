// The quad between a front segment and its next position becomes a fan around a new point. Snapping
// turns distances below `reach` into incidence: a point moves to the vertex of K, or the edge or
// triangle is divided there.
#include "crack/sweep.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "crack/index_map.h"
#include "crack/points.h"
#include "geometry/coordinate_order.h"
#include "geometry/predicates.h"

namespace geo {
namespace {

struct PointHash {
  std::size_t operator()(const Vec3& p) const { return crack::hash_of(p); }
};
using PointMap = crack::IndexMap<Vec3, PointHash>;  // indices of points by position

class StripBuilder {
 public:
  Strip strip;

  // The index of position p; a new point where there is none.
  std::uint32_t point(const Vec3& p, bool fixed) {
    std::uint32_t& index = indices_[p];
    if (index == ~0u) {
      index = static_cast<std::uint32_t>(strip.points.size());
      strip.points.push_back(p);
      strip.fixed.push_back(false);
    }
    if (fixed) strip.fixed[index] = true;
    return index;
  }
  // Returns whether it has an area, and is in the strip.
  bool triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::array<int, 3> segment) {
    if (a == b || b == c || c == a || collinear(strip.points[a], strip.points[b], strip.points[c])) return false;
    strip.triangles.push_back({{a, b, c}, segment});
    return true;
  }

 private:
  PointMap indices_;
};

using Ends = std::pair<std::uint32_t, std::uint32_t>;

// The triangles of segment i, whose points are p and q in its next position, and stand or not.
// Returns whether one has the new segment as a side.
bool add_triangles(StripBuilder& builder, const std::vector<std::uint32_t>& old, Ends next, int segment) {
  const auto [p, q] = next;
  const bool stands_q = old.back() == q;
  bool has_side = false;
  if (old.front() == p) {
    // A fan around q; its first side is the new front.
    for (std::size_t k = 0; k + 1 < old.size(); ++k) {
      const bool is_added = builder.triangle(old[k], old[k + 1], q, {-1, -1, k == 0 ? segment : -1});
      has_side = has_side || (is_added && k == 0);
    }
    return has_side;
  }
  // A fan around p, closed by the triangle that holds the new front (nothing when q stands still:
  // the fan's last side).
  for (std::size_t k = 0; k + 1 < old.size(); ++k) {
    const bool is_last = stands_q && k + 2 == old.size();
    const bool is_added = builder.triangle(old[k], old[k + 1], p, {-1, is_last ? segment : -1, -1});
    has_side = has_side || (is_added && is_last);
  }
  if (stands_q) return has_side;
  return builder.triangle(old.back(), q, p, {-1, segment, -1});
}

// Segments of the new front that are no side of their own triangles, as where two points were at
// one place and only one moves. They are sides of those beside them: else the front would not know
// the vertices of K on it. `segments`: their numbers and points.
void mark_sides(Strip& strip, const std::vector<std::pair<int, Ends>>& segments) {
  if (segments.empty()) return;
  std::map<Ends, std::pair<std::size_t, std::size_t>> side_of;  // by its points, in order: triangle and side
  for (std::size_t t = 0; t < strip.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(strip.triangles[t].p[k], strip.triangles[t].p[(k + 1) % 3]);
      if (strip.triangles[t].segment[k] < 0) side_of.try_emplace({a, b}, t, k);
    }
  for (const auto& [segment, ends] : segments) {
    const auto [a, b] = std::minmax(ends.first, ends.second);
    const auto found = side_of.find({a, b});
    if (found == side_of.end()) continue;
    strip.triangles[found->second.first].segment[found->second.second] = segment;
    side_of.erase(found);
  }
}

}  // namespace

bool Strip::is_on_old_front(const Vec3& a, const Vec3& b) const {
  return std::any_of(old_front.begin(), old_front.end(), [&](const auto& ends) {
    const Vec3 &p = points[ends.first], &q = points[ends.second];
    return (p == a && q == b) || (p == b && q == a);
  });
}

Strip sweep(const FrontState& front, std::span<const Vec3> next) {
  StripBuilder builder;
  builder.strip.new_front.assign(next.begin(), next.end());
  for (const auto& segment : front.segments)
    for (const auto& p : segment) builder.point(p.position, true);
  std::vector<std::pair<int, Ends>> without_side;
  for (std::size_t i = 0; i < front.segments.size(); ++i) {
    std::vector<std::uint32_t> old;
    for (const auto& p : front.segments[i]) {
      const auto index = builder.point(p.position, true);
      if (old.empty() || old.back() != index) old.push_back(index);
    }
    if (front.has_moved)
      for (std::size_t k = 0; k + 1 < old.size(); ++k) builder.strip.old_front.emplace_back(old[k], old[k + 1]);
    const Ends ends{builder.point(next[i], false), builder.point(next[(i + 1) % next.size()], false)};
    if (old.front() == ends.first && old.back() == ends.second) continue;
    const int segment = static_cast<int>(i);
    if (!add_triangles(builder, old, ends, segment) && ends.first != ends.second)
      without_side.push_back({segment, ends});
  }
  mark_sides(builder.strip, without_side);
  return std::move(builder.strip);
}

Strip strip_of(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  StripBuilder builder;
  std::vector<std::uint32_t> index;
  for (const Vec3& p : points) index.push_back(builder.point(p, false));
  for (const auto& t : triangles) builder.triangle(index[t[0]], index[t[1]], index[t[2]], {-1, -1, -1});
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

namespace {

// The phases of snap_to_vertices().
class Snapper {
 public:
  Snapper(Strip& strip, const Complex& complex, double reach) : strip_(strip), complex_(complex), reach_(reach) {
    for (const Vec3& p : strip.points) positions_[p] = 0;
  }

  std::size_t run() {
    for (const VertexId v : candidates()) {
      const Vec3 q = complex_.point(v);
      if (positions_.find(q) != ~0u) continue;
      if (!snap_point(q) && !divide_edge(q)) divide_triangle(q);
    }
    return count_;
  }

 private:
  // Vertices of K within reach of a triangle's plane and box, few, ordered by coordinates: ids of a
  // complex that was read back are others.
  std::vector<VertexId> candidates() const {
    std::vector<VertexId> vertices;
    for (std::size_t t = 0; t < strip_.triangles.size(); ++t) {
      const auto& tri = strip_.triangles[t].p;
      const Vec3 &p0 = strip_.points[tri[0]], n = (strip_.points[tri[1]] - p0).cross(strip_.points[tri[2]] - p0);
      const double limit = 2 * reach_ * n.norm();
      const Box3 box = box_of(p0, strip_.points[tri[1]], strip_.points[tri[2]]).grown(reach_);
      for (auto f = strip_.near_begin[t]; f < strip_.near_begin[t + 1]; ++f)
        for (const VertexId v : complex_.face(strip_.near[f]).v) {
          const Vec3& q = complex_.point(v);
          if (std::abs(n.dot(q - p0)) <= limit && Box3{q, q}.meets(box)) vertices.push_back(v);
        }
    }
    std::sort(vertices.begin(), vertices.end(),
              [&](VertexId a, VertexId b) { return is_before(complex_.point(a), complex_.point(b)); });
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
  }

  // Moves the first point within reach to q, if it is free. False when no point is within reach.
  bool snap_point(const Vec3& q) {
    for (std::uint32_t i = 0; i < strip_.points.size(); ++i) {
      if ((strip_.points[i] - q).squaredNorm() > reach_ * reach_) continue;
      if (strip_.fixed[i]) return true;
      for (auto& n : strip_.new_front)
        if (n == strip_.points[i]) n = q;
      strip_.points[i] = q;
      strip_.fixed[i] = true;
      positions_[q] = 0;
      ++count_;
      return true;
    }
    return false;
  }

  std::uint32_t add_point(const Vec3& q) {
    strip_.points.push_back(q);
    strip_.fixed.push_back(true);
    positions_[q] = 0;
    ++count_;
    return static_cast<std::uint32_t>(strip_.points.size() - 1);
  }

  // The first edge that passes within reach of q and may be divided.
  std::optional<std::pair<std::uint32_t, std::uint32_t>> edge_near(const Vec3& q) const {
    for (const auto& t : strip_.triangles)
      for (int k = 0; k < 3; ++k) {
        const auto a = t.p[k], b = t.p[(k + 1) % 3];
        const Vec3 e = strip_.points[b] - strip_.points[a], w = q - strip_.points[a];
        const double along = e.dot(w), length = e.squaredNorm();
        if (along <= 0 || along >= length || e.cross(w).squaredNorm() > reach_ * reach_ * length) continue;
        if (!strip_.is_on_old_front(strip_.points[a], strip_.points[b])) return {{a, b}};
      }
    return {};
  }

  // Divides the edge near q there, in each triangle that has it. False when none may be.
  bool divide_edge(const Vec3& q) {
    const auto edge = edge_near(q);
    if (!edge) return false;
    const auto [a, b] = *edge;
    const auto point = add_point(q);
    const std::size_t triangles = strip_.triangles.size();
    for (std::size_t t = 0; t < triangles; ++t)
      for (int k = 0; k < 3; ++k) {
        auto& tri = strip_.triangles[t];
        const auto u = tri.p[k], w = tri.p[(k + 1) % 3];
        if (!((u == a && w == b) || (u == b && w == a))) continue;
        Strip::Triangle half = tri;  // keeps p[k+1]; the original keeps p[k]
        half.p[k] = point;
        half.segment[(k + 2) % 3] = -1;
        tri.p[(k + 1) % 3] = point;
        tri.segment[(k + 1) % 3] = -1;
        strip_.triangles.push_back(half);
        break;
      }
    return true;
  }

  // Divides the first triangle that q is near and inside of, if any.
  void divide_triangle(const Vec3& q) {
    const std::size_t triangles = strip_.triangles.size();
    for (std::size_t t = 0; t < triangles; ++t) {
      const auto tri = strip_.triangles[t];
      const Vec3 &p0 = strip_.points[tri.p[0]], &p1 = strip_.points[tri.p[1]], &p2 = strip_.points[tri.p[2]];
      const Vec3 n = (p1 - p0).cross(p2 - p0);
      if (std::abs(n.dot(q - p0)) > reach_ * n.norm()) continue;
      if ((p1 - p0).cross(q - p0).dot(n) <= 0 || (p2 - p1).cross(q - p1).dot(n) <= 0 ||
          (p0 - p2).cross(q - p2).dot(n) <= 0)
        continue;
      const auto point = add_point(q);
      for (int k = 0; k < 3; ++k) {
        const Strip::Triangle part{{tri.p[k], tri.p[(k + 1) % 3], point}, {tri.segment[k], -1, -1}};
        if (k == 0)
          strip_.triangles[t] = part;
        else
          strip_.triangles.push_back(part);
      }
      return;
    }
  }

  Strip& strip_;
  const Complex& complex_;
  const double reach_;
  PointMap positions_;  // of the strip's points; the values mean nothing
  std::size_t count_ = 0;
};

}  // namespace

std::size_t snap_to_vertices(Strip& strip, const Complex& complex, double reach) {
  find_near(strip, complex, reach);
  if (strip.triangles.empty()) return 0;
  const std::size_t count = Snapper(strip, complex, reach).run();
  if (count > 0) {
    std::erase_if(strip.triangles, [&](const Strip::Triangle& t) {
      return collinear(strip.points[t.p[0]], strip.points[t.p[1]], strip.points[t.p[2]]);
    });
    find_near(strip, complex, reach);
  }
  return count;
}

}  // namespace geo
