// A symmetric positive matrix whose rows end not far from the diagonal, in tiles of six, and its Cholesky factor.
#pragma once

#include <cstddef>
#include <vector>

namespace geo {

class BandFactor {
 public:
  /// Zero; `last`: per tile row the last tile that is not zero.
  explicit BandFactor(const std::vector<std::size_t>& last);
  /// Entry (row, column) with row ≤ column, within the band.
  float& at(std::size_t row, std::size_t column) {
    return tile_row(row / 6)[row % 6 * stride_[row / 6] + column - row / 6 * 6];
  }
  /// Replaces the matrix by its factor. A row that is not positive beyond rounding is taken out: it answers with zero.
  void factor();
  /// x = matrix⁻¹ x, after factor().
  void solve(float* x) const;

 private:
  // Six rows as long as each other, from the diagonal tile's first column on, with room behind them.
  float* tile_row(std::size_t g) { return &values_[begin_[g]]; }
  const float* tile_row(std::size_t g) const { return &values_[begin_[g]]; }
  std::size_t length(std::size_t g) const { return 6 * (last_[g] + 1 - g); }
  void factor(std::size_t from, std::size_t to);
  void solve(std::size_t from, std::size_t to, float* x) const;
  std::vector<std::size_t> last_, begin_, stride_;  // per tile row
  std::vector<std::size_t> ranges_;                 // tile rows where nothing reaches across, and one past the last
  std::vector<float> inverse_;                      // of the factor's diagonal
  std::vector<float> values_;
};

}  // namespace geo
