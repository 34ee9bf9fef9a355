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
  float& at(std::size_t row, std::size_t column) { return values_[begin_[row] + column - row]; }
  /// Replaces the matrix by its factor. A row that is not positive beyond rounding is taken out: it answers with zero.
  void factor();
  /// x = matrix⁻¹ x, after factor().
  void solve(float* x) const;

 private:
  float* row(std::size_t i) { return &values_[begin_[i]]; }
  const float* row(std::size_t i) const { return &values_[begin_[i]]; }
  void factor(std::size_t from, std::size_t to);
  void solve(std::size_t from, std::size_t to, float* x) const;
  std::vector<std::size_t> last_, begin_;  // per tile row; per row: where its diagonal is
  std::vector<std::size_t> ranges_;        // tile rows where nothing reaches across, and one past the last
  std::vector<float> inverse_;             // of the factor's diagonal
  std::vector<float> values_;
};

}  // namespace geo
