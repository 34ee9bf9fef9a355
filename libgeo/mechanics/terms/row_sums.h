// Weighed sums of nodes' values for many rows, by all threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "kerf/parallel.h"
#include "mechanics/terms/row_lanes.h"

namespace geo {

/// Each with a zero.
inline std::vector<FourNumbers> four_numbers(const std::vector<Vec3>& values) {
  std::vector<FourNumbers> result(values.size());
  parallel_for(values.size(), 8192, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[i] = {values[i][0], values[i][1], values[i][2], 0};
  });
  return result;
}

/// take(k, sum) for each k below count, from any thread: of row_of(k), with the values of nodes that are weighed().
template <class RowOf, class Take>
void each_row_sum(std::size_t count, const std::vector<Vec3>& values, const RowOf& row_of, const Take& take) {
  if (count == 0) return;
  const std::vector<FourNumbers> numbers = four_numbers(values);
  parallel_for((count + rows_together - 1) / rows_together, 16, [&](std::size_t begin, std::size_t end) {
    std::span<const NodeWeight> rows[rows_together];
    FourNumbers sums[rows_together];
    for (std::size_t g = begin; g < end; ++g) {
      const std::size_t first = g * rows_together, own = std::min(rows_together, count - first);
      for (std::size_t r = 0; r < rows_together; ++r) rows[r] = row_of(first + std::min(r, own - 1));
      sum_rows(rows, numbers.data(), sums);
      for (std::size_t r = 0; r < own; ++r) take(first + r, Vec3(sums[r].at[0], sums[r].at[1], sums[r].at[2]));
    }
  });
}

}  // namespace geo
