// The inner loop of weighed sums, in vectors.
#pragma once

#include <cstddef>
#include <span>

#include "mechanics/terms/potential.h"

namespace geo {

/// Three coordinates and a zero, which one vector holds.
struct alignas(32) FourNumbers {
  double at[4];
};

/// So many rows are summed side by side, so that their sums wait for each other less.
constexpr std::size_t rows_together = 8;
/// sums[r] = Σ weight × values[node] over rows[r], each in its own order: the same as alone, and the same for any
/// processor.
void sum_rows(const std::span<const NodeWeight> (&rows)[rows_together], const FourNumbers* values,
              FourNumbers (&sums)[rows_together]);

}  // namespace geo
