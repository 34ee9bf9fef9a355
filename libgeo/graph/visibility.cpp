#include "graph/visibility.h"

#include <algorithm>

#include "base/parallel.h"

namespace geo {

Visibility::Visibility(std::span<const Vec3> positions, const TriangleBvh& obstacles, std::span<const double> reach)
    : positions_(positions), obstacles_(obstacles), clearance_(positions.size()) {
  parallel_for(positions.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto c = obstacles.closest(positions[i], reach[i]);
      clearance_[i] = c.row == ~0u ? reach[i] : c.distance;
    }
  });
}

bool Visibility::blocked(NodeId i, NodeId j) const {
  const auto a = std::min(i, j).index(), b = std::max(i, j).index();
  const Vec3 &p = positions_[a], &q = positions_[b];
  // Two empty balls that cover the segment: nothing can block it. The margin is for rounding in the distances.
  if ((p - q).norm() < (clearance_[a] + clearance_[b]) * (1 - 1e-9)) return false;
  return obstacles_.blocks(p, q);
}

std::vector<std::uint8_t> Visibility::blocked(std::span<const std::pair<NodeId, NodeId>> pairs) const {
  std::vector<std::uint8_t> result(pairs.size());
  parallel_for(pairs.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) result[e] = blocked(pairs[e].first, pairs[e].second);
  });
  return result;
}

}  // namespace geo
