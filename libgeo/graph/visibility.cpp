// Segments with a common first node are tested in batches, so that they share one descent of the
// BVH.
#include "graph/visibility.h"

#include <algorithm>

#include "kerf/parallel.h"

namespace geo {

void Visibility::blocked(NodeId i, std::span<const NodeId> to, std::span<std::uint8_t> result) const {
  constexpr std::size_t batch = 32;  // segments of a descent, on the stack; any size gives the same result
  Vec3 ends[batch];
  for (std::size_t first = 0; first < to.size(); first += batch) {
    const std::size_t count = std::min(batch, to.size() - first);
    for (std::size_t q = 0; q < count; ++q) ends[q] = positions_[to[first + q].index()];
    obstacles_.blocks(positions_[i.index()], {ends, count}, result.data() + first);
  }
}

std::vector<std::uint8_t> Visibility::blocked(std::span<const std::pair<NodeId, NodeId>> pairs) const {
  std::vector<std::uint8_t> result(pairs.size());
  parallel_for(pairs.size(), 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<NodeId> to;
    for (std::size_t e = begin; e < end; e += to.size()) {
      to.clear();
      while (e + to.size() < end && pairs[e + to.size()].first == pairs[e].first)
        to.push_back(pairs[e + to.size()].second);
      blocked(pairs[e].first, to, std::span(result).subspan(e, to.size()));
    }
  });
  return result;
}

}  // namespace geo
