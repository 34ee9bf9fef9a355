// 3×3 matrices of many material points, laid out for vector registers.
#pragma once

#include <cstddef>
#include <vector>

namespace geo {

/// Column c of point i's matrix is at column[c] + 4 i; its fourth number is padding.
template <class Number>
struct PointMatrices {
  std::vector<Number> column[3];
  /// Makes space for `points` matrices, rounded up to a multiple of eight.
  void resize(std::size_t points) {
    for (auto& c : column) c.resize(4 * ((points + 7) / 8 * 8));
  }
};

}  // namespace geo
