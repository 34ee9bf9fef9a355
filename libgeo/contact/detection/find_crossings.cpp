// Pairs without a common vertex come from a tree of boxes, pairs at a vertex from fans that are not
// height fields. A floating-point filter precedes the exact test faces_cross() (kerf/contact.h).
#include "contact/detection/find_crossings.h"

#include <algorithm>
#include <numeric>

#include "contact/detection/disjointness_filter.h"
#include "geometry/aabb_tree.h"
#include "kerf/check.h"
#include "kerf/contact.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

using Pairs = std::vector<TrianglePair>;

std::vector<Box3> boxes_of(const std::vector<Triangle>& triangles, const std::vector<Vec3>& positions) {
  std::vector<Box3> boxes(triangles.size());
  parallel_for(boxes.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      boxes[t] = box_of(positions[triangles[t][0]], positions[triangles[t][1]], positions[triangles[t][2]]);
  });
  return boxes;
}

// Crossings of all triangles. Pairs without a common vertex come from the tree, which must know the
// triangles; the others come from the fans.
Pairs all_crossings(const AabbTree& tree, const VertexFans& fans, const std::vector<Triangle>& triangles,
                    const std::vector<Vec3>& positions, std::span<const std::uint32_t> representative, bool two_sided) {
  std::vector<Triangle> represented = triangles;
  for (Triangle& t : represented)
    for (auto& v : t) v = representative[v];
  Pairs result = tree.pairs(nullptr, [&](Pairs& pairs) {
    remove_disjoint(represented, positions, pairs);
    std::erase_if(pairs, [&](const auto& p) {
      return !triangles_cross(represented[p.first], represented[p.second], positions, two_sided);
    });
  });
  std::vector<std::uint8_t> certified(fans.size(), 0);
  const std::vector<std::uint8_t> all(triangles.size(), 1);
  const auto uncertified = fans.find_uncertified(all, representative, positions, certified);
  const Pairs at_vertices = crossings_at_vertices(fans, uncertified, certified, represented, positions, two_sided, all);
  result.insert(result.end(), at_vertices.begin(), at_vertices.end());
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace

std::vector<std::uint32_t> coincident_representatives(std::span<const std::uint32_t> site,
                                                      const std::vector<Vec3>& positions) {
  constexpr std::uint32_t none = ~0u;
  std::vector<std::uint32_t> result(positions.size());
  std::iota(result.begin(), result.end(), 0u);
  if (site.empty()) return result;
  // A hash table by site: the last vertex of each bucket, and for each vertex the one before it.
  std::vector<std::uint32_t> last(positions.size(), none), before(positions.size());
  for (std::uint32_t v = 0; v < result.size(); ++v) {
    auto& latest = last[site[v] % last.size()];
    for (auto w = latest; w != none && result[v] == v; w = before[w])
      if (site[w] == site[v] && positions[w] == positions[v]) result[v] = result[w];
    before[v] = latest;
    latest = v;
  }
  return result;
}

bool triangles_cross(const Triangle& s, const Triangle& t, const std::vector<Vec3>& positions, bool two_sided) {
  const std::array<Vec3, 3> p{positions[s[0]], positions[s[1]], positions[s[2]]},
      q{positions[t[0]], positions[t[1]], positions[t[2]]};
  if (!box_of(p[0], p[1], p[2]).meets(box_of(q[0], q[1], q[2]))) return false;
  int shared = 0;
  for (const auto v : s) shared += v == t[0] || v == t[1] || v == t[2];
  return !(shared == 3 && two_sided) && faces_cross(s, p, t, q);
}

std::vector<TrianglePair> find_crossings(const std::vector<Triangle>& triangles, const std::vector<Vec3>& positions,
                                         std::span<const std::uint32_t> representative, bool two_sided,
                                         const std::vector<std::uint8_t>* marked) {
  std::vector<Box3> boxes = boxes_of(triangles, positions);
  if (!marked)
    return all_crossings(AabbTree(std::move(boxes), triangles), VertexFans(triangles, positions.size()), triangles,
                         positions, representative, two_sided);
  Box3 region;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if ((*marked)[t]) region.add(boxes[t]);
  for (Box3& b : boxes)
    if (!b.meets(region)) b = Box3();
  Pairs result = find_crossings(overlapping_pairs(std::move(boxes), marked), triangles, positions, representative,
                                two_sided, marked);
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<TrianglePair> find_crossings(std::span<const TrianglePair> pairs, const std::vector<Triangle>& triangles,
                                         const std::vector<Vec3>& positions,
                                         std::span<const std::uint32_t> representative, bool two_sided,
                                         const std::vector<std::uint8_t>* marked) {
  std::vector<std::uint8_t> crosses(pairs.size(), 0);
  parallel_for(pairs.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto [s, t] = pairs[i];
      if (marked && !(*marked)[s] && !(*marked)[t]) continue;
      const auto &a = triangles[s], &b = triangles[t];
      crosses[i] =
          triangles_cross({representative[a[0]], representative[a[1]], representative[a[2]]},
                          {representative[b[0]], representative[b[1]], representative[b[2]]}, positions, two_sided);
    }
  });
  Pairs result;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (crosses[i]) result.push_back(pairs[i]);
  return result;
}

std::vector<TrianglePair> crossings_at_vertices(const VertexFans& fans, std::span<const std::uint32_t> uncertified,
                                                const std::vector<std::uint8_t>& certified,
                                                const std::vector<Triangle>& triangles,
                                                const std::vector<Vec3>& positions, bool two_sided,
                                                const std::vector<std::uint8_t>& changed) {
  std::vector<Pairs> found(uncertified.size());
  parallel_for(uncertified.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      fans.for_each_pair(
          uncertified[i], [&, v = uncertified[i]](std::uint32_t w) { return w < v || certified[w]; },
          [&](std::uint32_t s, std::uint32_t t) {
            if ((changed[s] || changed[t]) && triangles_cross(triangles[s], triangles[t], positions, two_sided))
              found[i].push_back({s, t});
          });
  });
  Pairs result;
  for (const Pairs& f : found) result.insert(result.end(), f.begin(), f.end());
  return result;
}

// Data that consecutive surfaces share.
struct CrossingCounter::Cache {
  VertexFans fans;
  AabbTree tree;
};

CrossingCounter::CrossingCounter() : cache_(std::make_unique<Cache>()) {}
CrossingCounter::~CrossingCounter() = default;
CrossingCounter::CrossingCounter(CrossingCounter&&) noexcept = default;
CrossingCounter& CrossingCounter::operator=(CrossingCounter&&) noexcept = default;

std::size_t CrossingCounter::count(const TriangleMesh& surface) {
  auto& [fans, tree] = *cache_;
  std::vector<Box3> boxes = boxes_of(surface.triangles, surface.vertices);
  const bool known = fans.size() == surface.vertices.size() && fans.triangles() == surface.triangles;
  if (!known) {
    fans = VertexFans(surface.triangles, surface.vertices.size());
    tree = {};
  }
  tree.refit_or_rebuild(std::move(boxes), surface.triangles);
  return all_crossings(tree, fans, surface.triangles, surface.vertices,
                       coincident_representatives(surface.site, surface.vertices), surface.two_sided())
      .size();
}

std::size_t count_crossings(const TriangleMesh& surface) { return CrossingCounter().count(surface); }

}  // namespace geo
