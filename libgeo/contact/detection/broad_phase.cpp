// The tree keeps the boxes of a step. Only triangles that have left their box are queried again,
// and their pairs in the list are replaced.
#include "contact/detection/broad_phase.h"

#include <algorithm>
#include <optional>

#include "kerf/parallel.h"

namespace geo {
namespace {

bool contains(const Box3& box, const Box3& inner) {
  return (inner.lo.array() >= box.lo.array()).all() && (inner.hi.array() <= box.hi.array()).all();
}

}  // namespace

bool BroadPhase::update(std::span<const Triangle> triangles, const std::function<Box3(std::size_t)>& box, double margin,
                        const std::vector<std::uint8_t>* changed, std::size_t most) {
  constexpr std::size_t rebuild_share = 4;  // rebuild if more than 1/4 have left their boxes; affects speed alone
  const bool valid = valid_ && tree_.boxes().size() == triangles.size(), changed_only = valid && changed;
  std::vector<Box3> boxes(changed_only ? 0 : triangles.size());
  std::vector<std::uint8_t> outside(triangles.size(), 0);
  parallel_for(triangles.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      if (changed_only && !(*changed)[t]) continue;
      const Box3 now = box(t);
      outside[t] = valid && !contains(tree_.boxes()[t], now);
      if (!changed_only) boxes[t] = now;
    }
  });
  const auto count = static_cast<std::size_t>(std::count(outside.begin(), outside.end(), 1));
  if (valid && count == 0 && pairs_.size() <= most) return true;
  if (!valid || (count * rebuild_share > triangles.size() && !changed)) {
    valid_ = false;
    tree_.refit_or_rebuild(std::move(boxes), triangles);
    std::optional<std::vector<Pair>> all = tree_.pairs_up_to(most, marked_.empty() ? nullptr : &marked_);
    valid_ = all.has_value();
    pairs_ = std::move(all).value_or(std::vector<Pair>());
    return valid_;
  }
  valid_ = false;  // until the list is complete
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    if (outside[t]) tree_.enlarge(t, (changed_only ? box(t) : boxes[t]).grown(margin));
  std::erase_if(pairs_, [&](const Pair& p) { return outside[p.first] || outside[p.second]; });
  const auto added = tree_.pairs_up_to(most - std::min(most, pairs_.size()), &outside);
  if (!added || pairs_.size() > most) {  // the boxes alone, without margins, may have fewer
    invalidate();
    return update(triangles, box, margin, nullptr, most);
  }
  pairs_.insert(pairs_.end(), added->begin(), added->end());
  return valid_ = true;
}

double BroadPhase::update_for_share(std::span<const Triangle> triangles, const std::function<Box3(std::size_t)>& box,
                                    double margin, const std::function<void(double)>& take) {
  constexpr double least_motion = 1.0 / 128;
  most_of_motion_ = max_per_triangle * triangles.size();
  if (update(triangles, box, margin, nullptr, most_of_motion_)) return 1;
  // Long triangles that are oblique to the axes have many pairs at rest.
  take(0);
  update(triangles, box, margin);
  most_of_motion_ += pairs_.size();
  for (double share = 1; share >= least_motion; share /= 2) {
    take(share);
    if (update(triangles, box, margin, nullptr, most_of_motion_)) return share;
  }
  take(0);
  update(triangles, box, margin);
  return 0;
}

}  // namespace geo
