#include "contact/detection/near_pairs.h"

#include <algorithm>

#include "kerf/parallel.h"

namespace geo {
namespace {

bool within(const Box3& box, const Box3& other) {
  return (box.lo.array() >= other.lo.array()).all() && (box.hi.array() <= other.hi.array()).all();
}

}  // namespace

void NearPairs::cover(std::span<const Triangle> triangles, const std::function<Box3(std::size_t)>& box, double spare,
                      const std::vector<std::uint8_t>* changed) {
  constexpr std::size_t most_outside = 4;  // one of so many
  const bool known = known_ && tree_.boxes().size() == triangles.size(), few = known && changed;
  std::vector<Box3> boxes(few ? 0 : triangles.size());
  std::vector<std::uint8_t> outside(triangles.size(), 0);
  parallel_for(triangles.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      if (few && !(*changed)[t]) continue;
      const Box3 now = box(t);
      outside[t] = known && !within(now, tree_.boxes()[t]);
      if (!few) boxes[t] = now;
    }
  });
  const auto count = static_cast<std::size_t>(std::count(outside.begin(), outside.end(), 1));
  if (known && count == 0) return;
  if (!known || (count * most_outside > triangles.size() && !changed)) {
    tree_.put(std::move(boxes), triangles);
    known_ = true, pairs_ = tree_.pairs();
    return;
  }
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    if (outside[t]) tree_.enlarge(t, (few ? box(t) : boxes[t]).grown(spare));
  std::erase_if(pairs_, [&](const Pair& p) { return outside[p.first] || outside[p.second]; });
  const auto more = tree_.pairs(&outside);
  pairs_.insert(pairs_.end(), more.begin(), more.end());
}

}  // namespace geo
