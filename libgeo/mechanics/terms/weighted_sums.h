// Weighted sums of nodal values over many stencils, in parallel.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "kerf/parallel.h"
#include "mechanics/terms/weighted_sum_lanes.h"

namespace geo {

/// The values, each padded with a zero.
inline std::vector<PaddedVec3> padded(const std::vector<Vec3>& values) {
  std::vector<PaddedVec3> result(values.size());
  parallel_for(values.size(), 8192, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[i] = {values[i][0], values[i][1], values[i][2], 0};
  });
  return result;
}

/// Calls use(k, weighted_sum(stencil_of(k), values)) for each k < count, from several threads. The
/// sums are bitwise those of weighted_sum().
template <class StencilOf, class Use>
void for_each_weighted_sum(std::size_t count, const std::vector<Vec3>& values, const StencilOf& stencil_of,
                           const Use& use) {
  if (count == 0) return;
  const std::vector<PaddedVec3> padded_values = padded(values);
  parallel_for((count + stencils_per_batch - 1) / stencils_per_batch, 16, [&](std::size_t begin, std::size_t end) {
    Stencil stencils[stencils_per_batch];
    PaddedVec3 sums[stencils_per_batch];
    for (std::size_t batch = begin; batch < end; ++batch) {
      const std::size_t first = batch * stencils_per_batch, size = std::min(stencils_per_batch, count - first);
      // The last stencil fills the places of an incomplete batch.
      for (std::size_t s = 0; s < stencils_per_batch; ++s) stencils[s] = stencil_of(first + std::min(s, size - 1));
      weighted_sums(stencils, padded_values.data(), sums);
      for (std::size_t s = 0; s < size; ++s) use(first + s, Vec3(sums[s].at[0], sums[s].at[1], sums[s].at[2]));
    }
  });
}

}  // namespace geo
