#include "kerf/crossing.h"

#include <algorithm>
#include <numeric>

#include "contact/detection/box_tree.h"
#include "contact/detection/close_pairs.h"
#include "contact/detection/triangle_sides.h"
#include "kerf/check.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

std::vector<Box3> boxes_of(const std::vector<Triangle>& triangles, const std::vector<Vec3>& positions) {
  std::vector<Box3> boxes(triangles.size());
  parallel_for(boxes.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      boxes[t] = box_of(positions[triangles[t][0]], positions[triangles[t][1]], positions[triangles[t][2]]);
  });
  return boxes;
}

// Of all pairs; the tree knows which triangles its boxes are of.
Pairs crossings(const BoxTree& tree, const VertexFans& fans, const std::vector<Triangle>& triangles,
                const std::vector<Vec3>& positions, std::span<const std::uint32_t> together, bool two_sided) {
  std::vector<Triangle> standing = triangles;
  for (Triangle& t : standing)
    for (auto& v : t) v = together[v];
  Pairs result = tree.pairs(nullptr, [&](Pairs& pairs) {
    keep_unclear(standing, positions, pairs);
    std::erase_if(pairs, [&](const auto& p) {
      return !triangles_cross(standing[p.first], standing[p.second], positions, two_sided);
    });
  });
  std::vector<std::uint8_t> opens_out(fans.size(), 0);
  const std::vector<std::uint8_t> all(triangles.size(), 1);
  const auto shut = fans.find_shut(all, together, positions, opens_out);
  const Pairs about = crossings_about(fans, shut, opens_out, standing, positions, two_sided, all);
  result.insert(result.end(), about.begin(), about.end());
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace

std::vector<std::uint32_t> vertices_together(std::span<const std::uint32_t> site, const std::vector<Vec3>& positions) {
  constexpr std::uint32_t none = ~0u;
  std::vector<std::uint32_t> result(positions.size());
  std::iota(result.begin(), result.end(), 0u);
  if (site.empty()) return result;
  std::vector<std::uint32_t> last(positions.size(), none), before(positions.size());  // of the same remainder
  for (std::uint32_t v = 0; v < result.size(); ++v) {
    auto& latest = last[site[v] % last.size()];
    for (auto w = latest; w != none && result[v] == v; w = before[w])
      if (site[w] == site[v] && positions[w] == positions[v]) result[v] = result[w];
    before[v] = latest, latest = v;
  }
  return result;
}

bool triangles_cross(const Triangle& s, const Triangle& t, const std::vector<Vec3>& positions, bool two_sided) {
  const std::array<Vec3, 3> p{positions[s[0]], positions[s[1]], positions[s[2]]},
      q{positions[t[0]], positions[t[1]], positions[t[2]]};
  if (!box_of(p[0], p[1], p[2]).meets(box_of(q[0], q[1], q[2]))) return false;
  int same = 0;
  for (const auto v : s) same += v == t[0] || v == t[1] || v == t[2];
  return !(same == 3 && two_sided) && faces_cross(s, p, t, q);
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> find_crossings(const std::vector<Triangle>& triangles,
                                                                    const std::vector<Vec3>& positions,
                                                                    std::span<const std::uint32_t> together,
                                                                    bool two_sided,
                                                                    const std::vector<std::uint8_t>* only) {
  std::vector<Box3> boxes = boxes_of(triangles, positions);
  if (!only)
    return crossings(BoxTree(std::move(boxes), triangles), VertexFans(triangles, positions.size()), triangles,
                     positions, together, two_sided);
  Box3 region;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if ((*only)[t]) region.add(boxes[t]);
  for (Box3& b : boxes)
    if (!b.meets(region)) b = Box3();
  Pairs result = find_crossings(close_pairs(std::move(boxes), only), triangles, positions, together, two_sided, only);
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> find_crossings(
    std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs, const std::vector<Triangle>& triangles,
    const std::vector<Vec3>& positions, std::span<const std::uint32_t> together, bool two_sided,
    const std::vector<std::uint8_t>* only) {
  std::vector<std::uint8_t> crosses(pairs.size(), 0);
  parallel_for(pairs.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto [s, t] = pairs[i];
      if (only && !(*only)[s] && !(*only)[t]) continue;
      const auto &a = triangles[s], &b = triangles[t];
      crosses[i] = triangles_cross({together[a[0]], together[a[1]], together[a[2]]},
                                   {together[b[0]], together[b[1]], together[b[2]]}, positions, two_sided);
    }
  });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> result;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (crosses[i]) result.push_back(pairs[i]);
  return result;
}

Pairs crossings_about(const VertexFans& fans, std::span<const std::uint32_t> shut,
                      const std::vector<std::uint8_t>& opens_out, const std::vector<Triangle>& triangles,
                      const std::vector<Vec3>& positions, bool two_sided, const std::vector<std::uint8_t>& changed) {
  std::vector<Pairs> found(shut.size());
  parallel_for(shut.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      fans.each_pair(
          shut[i], [&, v = shut[i]](std::uint32_t w) { return w < v || opens_out[w]; },
          [&](std::uint32_t s, std::uint32_t t) {
            if ((changed[s] || changed[t]) && triangles_cross(triangles[s], triangles[t], positions, two_sided))
              found[i].push_back({s, t});
          });
  });
  Pairs result;
  for (const Pairs& f : found) result.insert(result.end(), f.begin(), f.end());
  return result;
}

std::size_t CrossingCounter::count(const TriangleMesh& surface) {
  std::vector<Box3> boxes = boxes_of(surface.triangles, surface.vertices);
  const bool known = fans_.size() == surface.vertices.size() && fans_.triangles() == surface.triangles;
  if (!known) fans_ = VertexFans(surface.triangles, surface.vertices.size()), tree_ = {};
  tree_.put(std::move(boxes), surface.triangles);
  return crossings(tree_, fans_, surface.triangles, surface.vertices, vertices_together(surface.site, surface.vertices),
                   surface.two_sided())
      .size();
}

std::size_t count_crossings(const TriangleMesh& surface) { return CrossingCounter().count(surface); }

}  // namespace geo
