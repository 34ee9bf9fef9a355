// Target positions of surface vertices: where Eq. 1 puts each for given displacements of the nodes.
#pragma once

#include <span>
#include <vector>

#include "contact/surface/surface_weights.h"

namespace geo {

/// Per surface vertex its target, world; zero for dead vertices. `u`: per node.
std::vector<Vec3> surface_targets(const SurfaceWeights& weights, const std::vector<Vec3>& u);

/// Remembers the targets of the last displacements. After a crack step at the same displacements
/// only targets of vertices with changed weights are computed. Not thread-safe.
class SurfaceTargetCache {
 public:
  /// The same as surface_targets(); valid until the next call.
  const std::vector<Vec3>& at(const SurfaceWeights& weights, const std::vector<Vec3>& u);
  /// These vertices are new or have other weights.
  void invalidate(std::span<const std::uint32_t> vertices) {
    stale_.insert(stale_.end(), vertices.begin(), vertices.end());
  }

 private:
  std::vector<Vec3> targets_, displacement_;  // the last result, and the displacements it is for
  std::vector<std::uint32_t> stale_;          // vertices invalidated since
};

}  // namespace geo
