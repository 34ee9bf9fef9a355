// Cholesky factorisation of a symmetric positive definite band matrix in tiles of 6 × 6, the six
// rigid motions of an aggregate. The width of the band varies from row to row.
#pragma once

#include <cstddef>
#include <vector>

namespace geo {

class BandCholesky {
 public:
  /// A zero matrix; `last`: per tile row the last tile that may be nonzero. Fill-in is reserved.
  explicit BandCholesky(const std::vector<std::size_t>& last);
  /// Entry (row, column). Precondition: row ≤ column, within the band, before factor().
  float& at(std::size_t row, std::size_t column) {
    return tile_row(row / 6)[row % 6 * stride_[row / 6] + column - row / 6 * 6];
  }
  /// Replaces the matrix by its factor. A row whose pivot is not positive beyond rounding is left
  /// out: its solution is zero.
  void factor();
  /// x = matrix⁻¹ x. Precondition: factor(); x has six numbers per tile row.
  void solve(float* x) const;

 private:
  // The six rows of tile row g, from the diagonal tile's first column on, stride_[g] apart.
  float* tile_row(std::size_t g) { return &values_[begin_[g]]; }
  const float* tile_row(std::size_t g) const { return &values_[begin_[g]]; }
  std::size_t length(std::size_t g) const { return 6 * (last_[g] + 1 - g); }
  void factor(std::size_t from, std::size_t to);
  void solve(std::size_t from, std::size_t to, float* x) const;

  std::vector<std::size_t> last_, begin_, stride_;  // per tile row
  std::vector<std::size_t> ranges_;                 // first tile rows of the decoupled diagonal blocks; their number
  std::vector<float> inverse_;                      // per row: inverse of the factor's diagonal entry
  std::vector<float> values_;
};

}  // namespace geo
