#include "contact/crossing.h"

#include <algorithm>
#include <numeric>

#include "base/parallel.h"
#include "contact/close_pairs.h"
#include "surface/check.h"

namespace geo {

std::vector<std::uint32_t> vertices_together(std::span<const std::uint32_t> site, const std::vector<Vec3>& positions) {
  std::vector<std::uint32_t> result(positions.size()), order(positions.size());
  std::iota(result.begin(), result.end(), 0u);
  if (site.empty()) return result;
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return site[a] < site[b]; });
  for (std::size_t i = 1; i < order.size(); ++i)
    for (std::size_t j = i; j-- > 0 && site[order[j]] == site[order[i]];)
      if (positions[order[j]] == positions[order[i]]) result[order[i]] = result[order[j]];
  return result;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> find_crossings(const std::vector<Triangle>& triangles, const std::vector<Vec3>& positions,
                                                                    std::span<const std::uint32_t> together, bool two_sided,
                                                                    const std::vector<std::uint8_t>* only) {
  std::vector<Box3> boxes(triangles.size());
  Box3 region;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    boxes[t] = box_of(positions[a], positions[b], positions[c]);
    if (only && (*only)[t]) region.add(boxes[t]);
  }
  if (only)
    for (Box3& b : boxes)
      if (!b.meets(region)) b = Box3();
  auto result = find_crossings(close_pairs(boxes, only), triangles, positions, together, two_sided, only);
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> find_crossings(std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs,
                                                                    const std::vector<Triangle>& triangles, const std::vector<Vec3>& positions,
                                                                    std::span<const std::uint32_t> together, bool two_sided,
                                                                    const std::vector<std::uint8_t>* only) {
  std::vector<std::uint8_t> crosses(pairs.size(), 0);
  parallel_for(pairs.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto [s, t] = pairs[i];
      if (only && !(*only)[s] && !(*only)[t]) continue;
      std::array<std::uint32_t, 3> f, g;
      std::array<Vec3, 3> p, q;
      int same = 0;
      for (int k = 0; k < 3; ++k) {
        f[k] = together[triangles[s][k]], g[k] = together[triangles[t][k]];
        p[k] = positions[f[k]], q[k] = positions[g[k]];
      }
      if (!box_of(p[0], p[1], p[2]).meets(box_of(q[0], q[1], q[2]))) continue;
      for (int k = 0; k < 3; ++k) same += f[k] == g[0] || f[k] == g[1] || f[k] == g[2];
      crosses[i] = same == 3 && two_sided ? 0 : faces_cross(f, p, g, q);
    }
  });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> result;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (crosses[i]) result.push_back(pairs[i]);
  return result;
}

std::size_t count_crossings(const TriangleMesh& surface) {
  return find_crossings(surface.triangles, surface.vertices, vertices_together(surface.site, surface.vertices), surface.two_sided()).size();
}

}  // namespace geo
