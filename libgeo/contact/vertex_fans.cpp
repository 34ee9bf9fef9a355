#include "contact/vertex_fans.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace geo {

VertexFans::VertexFans(const std::vector<Triangle>& triangles, std::size_t vertices) : first_(vertices + 1, 0), link_(3 * triangles.size()), closed_(vertices, 0) {
  constexpr std::uint32_t most = 32;  // of more nothing is said
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
      closed_[v] = links.size() >= 3 && links.size() <= most && std::all_of(links.begin(), links.end(), [&](const Link& one) {
        std::size_t same = 0, before = 0;
        for (const Link& other : links) same += other.from == one.from, before += other.to == one.from;
        return same == 1 && before == 1;
      });
    }
  });
}

bool VertexFans::open_out(std::uint32_t v, std::span<const std::uint32_t> together, const std::vector<Vec3>& at) const {
  if (!closed_[v]) return false;
  // Well beyond the rounding of a product of three vectors, over their lengths.
  constexpr double rounding = 1e-13;
  const Vec3& x = at[together[v]];
  Vec3 n = Vec3::Zero();
  for (const Link& l : about(v)) n += (at[together[l.from]] - x).cross(at[together[l.to]] - x);
  n.normalize();
  // All go around n the same way, so each turn leaves the half-space behind `across`, which n is parallel to, once.
  const Vec3 across = n.unitOrthogonal();
  int turns = 0;
  for (const Link& l : about(v)) {
    const Vec3 a = at[together[l.from]] - x, b = at[together[l.to]] - x;
    const double front = n.dot(a.cross(b));
    if (!(front > 0 && front * front > rounding * rounding * a.squaredNorm() * b.squaredNorm())) return false;
    turns += across.dot(a) < 0 && across.dot(b) >= 0;
  }
  return turns == 1;
}

std::vector<std::uint32_t> VertexFans::find_shut(const std::vector<std::uint8_t>& changed, std::span<const std::uint32_t> together, const std::vector<Vec3>& at,
                                                 std::vector<std::uint8_t>& opens_out) const {
  std::vector<std::uint8_t> is_shut(size(), 0);
  parallel_for(size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const auto links = about(v);
      if (std::none_of(links.begin(), links.end(), [&](const Link& l) { return changed[l.triangle]; })) continue;
      opens_out[v] = open_out(static_cast<std::uint32_t>(v), together, at);
      is_shut[v] = !opens_out[v];
    }
  });
  std::vector<std::uint32_t> shut;
  for (std::uint32_t v = 0; v < size(); ++v)
    if (is_shut[v]) shut.push_back(v);
  return shut;
}

}  // namespace geo
