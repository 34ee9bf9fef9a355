#include "contact/motion/vertex_advance.h"

#include <algorithm>

#include "contact/detection/aabb_tree.h"
#include "contact/motion/separating_planes.h"
#include "contact/motion/straight_motion.h"

namespace geo {

std::size_t advance_vertices(const std::vector<Triangle>& triangles, const std::vector<Vec3>& wanted, double edge,
                             double gap, std::vector<Vec3>& at) {
  constexpr double negligible = 0.01, farthest = 0.1;  // of an edge: not worth a plane, and as far as planes let one go
  std::vector<double> room(at.size(), 0);
  std::vector<Vec3> to = at;
  std::vector<std::uint8_t> moving(triangles.size(), 0);
  std::vector<Box3> boxes(triangles.size());
  for (const auto& t : triangles)
    for (const auto v : t)
      if (const double way = (wanted[v] - at[v]).norm(); way > negligible * edge)
        room[v] = std::min(farthest * edge, way), to[v] = wanted[v];
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    double most = 0;
    for (const auto v : triangles[t]) most = std::max(most, room[v]), boxes[t].add(at[v]), boxes[t].add(to[v]);
    moving[t] = most > 0, boxes[t] = boxes[t].grown(most + 0.5 * gap);
  }
  if (std::count(moving.begin(), moving.end(), 1) == 0) return 0;
  const auto pairs = overlapping_pairs(std::move(boxes), &moving);
  move_straight(triangles, pairs, to, gap, at);
  for (std::size_t v = 0; v < at.size(); ++v)
    if (room[v] > 0) room[v] = std::min(room[v], (to[v] - at[v]).norm());
  return move_between_planes({triangles, pairs, to, room, gap}, at);
}

}  // namespace geo
