// Straight motion first (cheap, no planes), then planes for the vertices that still lag behind.
#include "contact/motion/vertex_advance.h"

#include <algorithm>

#include "contact/motion/separating_planes.h"
#include "contact/motion/straight_motion.h"
#include "geometry/aabb_tree.h"

namespace geo {

std::size_t advance_vertices(const std::vector<Triangle>& triangles, const std::vector<Vec3>& to, double edge,
                             double gap, std::vector<Vec3>& at) {
  constexpr double negligible = 0.01;  // of an edge: a smaller error is not worth a plane
  constexpr double farthest = 0.1;     // of an edge: longer moves would need planes between too many pairs
  std::vector<double> limit(at.size(), 0);
  std::vector<Vec3> target = at;
  std::vector<std::uint8_t> moving(triangles.size(), 0);
  std::vector<Box3> boxes(triangles.size());
  for (const auto& t : triangles)
    for (const auto v : t)
      if (const double error = (to[v] - at[v]).norm(); error > negligible * edge)
        limit[v] = std::min(farthest * edge, error), target[v] = to[v];
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    double longest = 0;
    for (const auto v : triangles[t])
      longest = std::max(longest, limit[v]), boxes[t].add(at[v]), boxes[t].add(target[v]);
    moving[t] = longest > 0, boxes[t] = boxes[t].grown(longest + 0.5 * gap);
  }
  if (std::count(moving.begin(), moving.end(), 1) == 0) return 0;
  const auto pairs = overlapping_pairs(std::move(boxes), &moving);
  move_straight(triangles, pairs, target, gap, at);
  for (std::size_t v = 0; v < at.size(); ++v)
    if (limit[v] > 0) limit[v] = std::min(limit[v], (target[v] - at[v]).norm());
  return move_between_planes({triangles, pairs, target, limit, gap}, at);
}

}  // namespace geo
