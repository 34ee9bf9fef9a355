// Target = rest position + Σ w_i u_i over the vertex' stencil + rotated() (surface_weights.h).
#include "contact/surface/surface_targets.h"

#include <algorithm>
#include <numeric>

#include "kerf/parallel.h"

namespace geo {

std::vector<Vec3> surface_targets(const SurfaceWeights& weights, const std::vector<Vec3>& u) {
  constexpr std::size_t vertices_per_task = 1024;
  std::vector<std::uint32_t> all(weights.size());
  std::iota(all.begin(), all.end(), 0u);
  std::vector<Vec3> result = weights.interpolate(all, u);
  parallel_for(result.size(), vertices_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      if (weights.alive(v)) result[v] = weights.placed(v, result[v]);
  });
  return result;
}

const std::vector<Vec3>& SurfaceTargetCache::at(const SurfaceWeights& weights, const std::vector<Vec3>& u) {
  // A crack step appends nodes; vertices with unchanged weights do not depend on those.
  const bool unmoved = !displacement_.empty() && displacement_.size() <= u.size() &&
                       std::equal(displacement_.begin(), displacement_.end(), u.begin());
  if (unmoved) {
    targets_.resize(weights.size(), Vec3::Zero());
    const auto offsets = weights.interpolate(stale_, u);
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      const auto v = stale_[i];
      targets_[v] = weights.alive(v) ? weights.placed(v, offsets[i]) : Vec3(Vec3::Zero());
    }
  } else {
    targets_ = surface_targets(weights, u);
  }
  displacement_ = u;
  stale_.clear();
  return targets_;
}

}  // namespace geo
