#include "graph/nearest.h"

#include <cmath>

#include "base/parallel.h"
#include "sampling/node_grid.h"

namespace geo {

double grid_cell_for(std::span<const Vec3> positions) {
  Box3 box;
  for (const Vec3& p : positions) box.add(p);
  if (positions.size() < 2 || !(box.diagonal() > 0)) return 1;
  const Vec3 size = (box.hi - box.lo).cwiseMax(1e-3 * box.diagonal());
  return std::cbrt(1.5 * size.prod() / double(positions.size()));
}

std::vector<NodeId> nearest_nodes(std::span<const Vec3> positions, int k) {
  const NodeGrid grid(grid_cell_for(positions), positions);
  std::vector<NodeId> rows(positions.size() * static_cast<std::size_t>(k));
  parallel_for(positions.size(), 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto near = grid.nearest(positions, positions[i], static_cast<std::size_t>(k), static_cast<std::uint32_t>(i), [](auto) { return true; });
      for (std::size_t j = 0; j < near.size(); ++j) rows[i * static_cast<std::size_t>(k) + j] = NodeId(near[j]);
    }
  });
  return rows;
}

}  // namespace geo
