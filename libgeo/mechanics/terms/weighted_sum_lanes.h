// Weighted sums of several stencils at once, in vector registers.
#pragma once

#include <cstddef>

#include "kerf/potential.h"

namespace geo {

/// A 3-vector and a zero, aligned for one vector load.
struct alignas(32) PaddedVec3 {
  double at[4];
};

/// The number of stencils summed side by side: independent sums hide the latency of additions.
constexpr std::size_t stencils_per_batch = 8;

/// sums[s] = Σ weight × values[node] over stencils[s], in the stencil's order: bitwise the same as
/// weighted_sum() on any processor.
void weighted_sums(const Stencil (&stencils)[stencils_per_batch], const PaddedVec3* values,
                   PaddedVec3 (&sums)[stencils_per_batch]);

}  // namespace geo
