#include "contact/detection/vertex_fans.h"

#include <algorithm>
#include <cmath>

#include "geometry/predicates.h"
#include "kerf/parallel.h"

namespace geo {

VertexFans::VertexFans(const std::vector<Triangle>& triangles, std::size_t vertices)
    : triangles_(triangles), first_(vertices + 1, 0), link_(3 * triangles.size()), closed_(vertices, 0) {
  constexpr std::size_t most = 32;  // of more nothing is said
  for (const auto& t : triangles)
    for (const auto v : t) ++first_[v + 1];
  for (std::size_t v = 0; v < vertices; ++v) first_[v + 1] += first_[v];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    link_[next[a]++] = {b, c, t}, link_[next[b]++] = {c, a, t}, link_[next[c]++] = {a, b, t};
  }
  parallel_for(vertices, 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const auto links = about(v);
      closed_[v] =
          links.size() >= 3 && links.size() <= most && std::all_of(links.begin(), links.end(), [&](const Link& one) {
            std::size_t same = 0, before = 0;
            for (const Link& other : links) same += other.from == one.from, before += other.to == one.from;
            return same == 1 && before == 1;
          });
    }
  });
}

bool VertexFans::open_out(std::uint32_t v, const UninitializedArray<Front>& fronts,
                          std::span<const std::uint32_t> together, const std::vector<Vec3>& at) const {
  if (!closed_[v]) return false;
  // Well beyond the rounding of a product of three vectors, over their lengths.
  constexpr double rounding = 1e-13;
  Vec3 n = Vec3::Zero();
  for (const Link& l : about(v)) n += fronts[l.triangle].way();
  const double size = n.lpNorm<1>();
  // All go around n the same way, so each turn leaves the half-space behind `across`, which n is parallel to, to the
  // bit, once: between two corners that n sees further apart than rounding could move them.
  const Vec3 across = std::abs(n.x()) > std::abs(n.y()) ? Vec3(n.z(), 0, -n.x()) : Vec3(0, n.z(), -n.y());
  const Vec3& x = at[together[v]];
  int turns = 0;
  for (const Link& l : about(v)) {
    const Front& f = fronts[l.triangle];
    const double front = n.dot(f.way());
    if (!(front > rounding * size * f.longest && front > filter_smallest && front < filter_largest &&
          f.longest > filter_smallest))
      return false;
    turns += across.dot(at[together[l.from]] - x) < 0 && across.dot(at[together[l.to]] - x) >= 0;
  }
  return turns == 1;
}

std::vector<std::uint32_t> VertexFans::find_shut(const std::vector<std::uint8_t>& changed,
                                                 std::span<const std::uint32_t> together, const std::vector<Vec3>& at,
                                                 std::vector<std::uint8_t>& opens_out) const {
  std::vector<std::uint8_t> asked(size(), 0), is_shut(size(), 0);
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    if (changed[t])
      for (const auto v : triangles_[t]) asked[v] = 1;
  UninitializedArray<Front> fronts(triangles_.size());  // of triangles about a vertex that is asked for
  parallel_for(triangles_.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto& [a, b, c] = triangles_[t];
      if (!asked[a] && !asked[b] && !asked[c]) continue;
      const Vec3 p = at[together[a]], u = at[together[b]] - p, v = at[together[c]] - p;
      const Vec3 n = u.cross(v);
      fronts[t] = {{n.x(), n.y(), n.z()}, std::max({u.squaredNorm(), v.squaredNorm(), (v - u).squaredNorm()})};
    }
  });
  parallel_for(size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (!asked[v]) continue;
      opens_out[v] = open_out(static_cast<std::uint32_t>(v), fronts, together, at);
      is_shut[v] = !opens_out[v];
    }
  });
  std::vector<std::uint32_t> shut;
  for (std::uint32_t v = 0; v < size(); ++v)
    if (is_shut[v]) shut.push_back(v);
  return shut;
}

}  // namespace geo
