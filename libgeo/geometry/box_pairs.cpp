// Few boxes: sweep and prune along the longest axis. Many: a tree of boxes.
#include "geometry/box_pairs.h"

#include <algorithm>

namespace geo {
namespace {

// Below this number the sweep is faster than building a tree; it affects speed alone.
constexpr std::size_t many = 1000;

AabbTree::Pairs sweep_and_prune(const std::vector<Box3>& boxes) {
  Box3 all;
  for (const Box3& box : boxes) all.add(box);
  int axis = 0;
  if (!boxes.empty()) (all.hi - all.lo).maxCoeff(&axis);
  std::vector<std::pair<double, std::uint32_t>> order;
  order.reserve(boxes.size());
  for (std::uint32_t i = 0; i < boxes.size(); ++i) order.push_back({boxes[i].lo[axis], i});
  std::sort(order.begin(), order.end());
  AabbTree::Pairs pairs;
  for (std::size_t a = 0; a < order.size(); ++a) {
    const std::uint32_t i = order[a].second;
    const Box3& box = boxes[i];
    for (std::size_t b = a + 1; b < order.size() && order[b].first <= box.hi[axis]; ++b)
      if (const std::uint32_t j = order[b].second; box.meets(boxes[j]))
        pairs.push_back({std::min(i, j), std::max(i, j)});
  }
  return pairs;
}

}  // namespace

AabbTree::Pairs meeting_pairs(const std::vector<Box3>& boxes, const std::function<void(AabbTree::Pairs&)>& filter) {
  if (boxes.size() >= many) return AabbTree(boxes).pairs(nullptr, filter);
  AabbTree::Pairs pairs = sweep_and_prune(boxes);
  filter(pairs);
  return pairs;
}

}  // namespace geo
