// Height-field test: with n = Σ n_t over the fan, all n · n_t > 0 and the opposite edges wind once
// around n (cf. Volino and Magnenat-Thalmann 1994: normals in one half-space, contour simple).
#include "contact/detection/vertex_fans.h"

#include <algorithm>
#include <cmath>

#include "geometry/predicates.h"
#include "kerf/parallel.h"

namespace geo {

VertexFans::VertexFans(const std::vector<Triangle>& triangles, std::size_t vertices)
    : triangles_(triangles), first_(vertices + 1, 0), link_(3 * triangles.size()), closed_(vertices, 0) {
  constexpr std::size_t largest = 32;  // the test is quadratic; larger fans are rare and stay uncertified, same result
  for (const auto& t : triangles)
    for (const auto v : t) ++first_[v + 1];
  for (std::size_t v = 0; v < vertices; ++v) first_[v + 1] += first_[v];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    link_[next[a]++] = {b, c, t};
    link_[next[b]++] = {c, a, t};
    link_[next[c]++] = {a, b, t};
  }
  parallel_for(vertices, 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const auto links = fan(v);
      closed_[v] =
          links.size() >= 3 && links.size() <= largest && std::all_of(links.begin(), links.end(), [&](const Link& one) {
            std::size_t same = 0, before = 0;
            for (const Link& other : links) {
              same += other.from == one.from;
              before += other.to == one.from;
            }
            return same == 1 && before == 1;
          });
    }
  });
}

bool VertexFans::is_height_field(std::uint32_t v, const UninitializedArray<Front>& fronts,
                                 std::span<const std::uint32_t> representative, const std::vector<Vec3>& at) const {
  if (!closed_[v]) return false;
  // Exceeds the relative rounding error of a triple product.
  constexpr double rounding = 1e-13;
  Vec3 n = Vec3::Zero();
  for (const Link& l : fan(v)) n += fronts[l.triangle].normal();
  const double size = n.lpNorm<1>();
  // All opposite edges go around n in the same sense. Count how often they do so: each turn leaves
  // the half-space behind `across`, which is exactly orthogonal to n, once.
  const Vec3 across = std::abs(n.x()) > std::abs(n.y()) ? Vec3(n.z(), 0, -n.x()) : Vec3(0, n.z(), -n.y());
  const Vec3& x = at[representative[v]];
  int turns = 0;
  for (const Link& l : fan(v)) {
    const Front& f = fronts[l.triangle];
    const double front = n.dot(f.normal());
    if (!(front > rounding * size * f.longest && front > filter_smallest && front < filter_largest &&
          f.longest > filter_smallest))
      return false;
    turns += across.dot(at[representative[l.from]] - x) < 0 && across.dot(at[representative[l.to]] - x) >= 0;
  }
  return turns == 1;
}

std::vector<std::uint32_t> VertexFans::find_uncertified(const std::vector<std::uint8_t>& changed,
                                                        std::span<const std::uint32_t> representative,
                                                        const std::vector<Vec3>& at,
                                                        std::vector<std::uint8_t>& certified) const {
  std::vector<std::uint8_t> queried(size(), 0), fails(size(), 0);
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    if (changed[t])
      for (const auto v : triangles_[t]) queried[v] = 1;
  UninitializedArray<Front> fronts(triangles_.size());  // of triangles at queried vertices
  parallel_for(triangles_.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto& [a, b, c] = triangles_[t];
      if (!queried[a] && !queried[b] && !queried[c]) continue;
      const Vec3 p = at[representative[a]], u = at[representative[b]] - p, v = at[representative[c]] - p;
      const Vec3 n = u.cross(v);
      fronts[t] = {{n.x(), n.y(), n.z()}, std::max({u.squaredNorm(), v.squaredNorm(), (v - u).squaredNorm()})};
    }
  });
  parallel_for(size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (!queried[v]) continue;
      certified[v] = is_height_field(static_cast<std::uint32_t>(v), fronts, representative, at);
      fails[v] = !certified[v];
    }
  });
  std::vector<std::uint32_t> uncertified;
  for (std::uint32_t v = 0; v < size(); ++v)
    if (fails[v]) uncertified.push_back(v);
  return uncertified;
}

}  // namespace geo
