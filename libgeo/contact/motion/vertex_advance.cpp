// Straight motion first (cheap, no planes), then planes for the vertices that still lag behind.
#include "contact/motion/vertex_advance.h"

#include <algorithm>

#include "contact/motion/separating_planes.h"
#include "contact/motion/straight_motion.h"
#include "geometry/aabb_tree.h"

namespace geo {

namespace {

// Vertices that lag behind their targets, and the triangles that they might meet on the way.
struct Lagging {
  std::vector<double> limit;  // per vertex: longest move within planes, 0 where it does not lag
  std::vector<Vec3> target;   // per vertex
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
};

// `straight`: they move on the way to their targets only.
Lagging find_lagging(const std::vector<Triangle>& triangles, const std::vector<Vec3>& to, double edge, double gap,
                     bool straight, const std::vector<Vec3>& at) {
  constexpr double negligible = 0.01;  // of an edge: a smaller error is not worth a plane
  constexpr double farthest = 0.1;     // of an edge: longer moves would need planes between too many pairs
  Lagging result{std::vector<double>(at.size(), 0), at, {}};
  std::vector<std::uint8_t> moving(triangles.size(), 0);
  std::vector<Box3> boxes(triangles.size());
  for (const auto& t : triangles)
    for (const auto v : t)
      if (const double error = (to[v] - at[v]).norm(); error > negligible * edge) {
        result.limit[v] = std::min(farthest * edge, error);
        result.target[v] = to[v];
      }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    double longest = 0;
    for (const auto v : triangles[t]) {
      longest = std::max(longest, result.limit[v]);
      boxes[t].add(at[v]);
      boxes[t].add(result.target[v]);
    }
    moving[t] = longest > 0;
    boxes[t] = boxes[t].grown((straight ? 0 : longest) + 0.5 * gap);
  }
  if (std::count(moving.begin(), moving.end(), 1) > 0) result.pairs = overlapping_pairs(std::move(boxes), &moving);
  return result;
}

}  // namespace

std::size_t advance_vertices(const std::vector<Triangle>& triangles, const std::vector<Vec3>& to, double edge,
                             double gap, std::vector<Vec3>& at) {
  Lagging lagging = find_lagging(triangles, to, edge, gap, false, at);
  if (lagging.target == at) return 0;
  move_straight(triangles, lagging.pairs, lagging.target, gap, at);
  for (std::size_t v = 0; v < at.size(); ++v)
    if (lagging.limit[v] > 0) lagging.limit[v] = std::min(lagging.limit[v], (lagging.target[v] - at[v]).norm());
  return move_between_planes(
      {.triangles = triangles, .pairs = lagging.pairs, .to = lagging.target, .limit = lagging.limit, .gap = gap}, at);
}

void advance_free_vertices(const std::vector<Triangle>& triangles, const std::vector<Vec3>& to, double edge, double gap,
                           std::vector<Vec3>& at) {
  const Lagging lagging = find_lagging(triangles, to, edge, gap, true, at);
  if (lagging.target != at) move_straight(triangles, lagging.pairs, lagging.target, gap, at);
}

}  // namespace geo
