// Weighed sums of nodes' values for many rows, by all threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/parallel.h"
#include "mechanics/potential.h"

namespace geo {

/// take(k, sum) for each k below count, from any thread: of row_of(k), with the values of nodes that are weighed(). Four rows go side by side, so that their
/// sums wait for each other less; each is the same as alone.
template <class RowOf, class Take>
void each_row_sum(std::size_t count, const std::vector<Vec3>& values, const RowOf& row_of, const Take& take) {
  if (count == 0) return;
  std::vector<Eigen::Vector4d> padded(values.size());
  parallel_for(values.size(), 8192, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) padded[i] << values[i], 0;
  });
  constexpr std::size_t together = 4;
  parallel_for((count + together - 1) / together, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      const std::size_t first = g * together, own = std::min(together, count - first);
      std::span<const NodeWeight> rows[together];
      Eigen::Vector4d sum[together];
      std::size_t least = ~std::size_t(0);
      for (std::size_t r = 0; r < together; ++r) {
        rows[r] = row_of(first + std::min(r, own - 1)), sum[r].setZero();
        least = std::min(least, rows[r].size());
      }
      for (std::size_t k = 0; k < least; ++k)
        for (std::size_t r = 0; r < together; ++r) sum[r] += rows[r][k].weight * padded[rows[r][k].node];
      for (std::size_t r = 0; r < own; ++r) {
        for (std::size_t k = least; k < rows[r].size(); ++k) sum[r] += rows[r][k].weight * padded[rows[r][k].node];
        take(first + r, Vec3(sum[r].head<3>()));
      }
    }
  });
}

}  // namespace geo
