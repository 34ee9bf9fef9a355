// Right-looking block Cholesky A = RᵀR, tile row by tile row: factor R_gg, then R_gh = R_gg⁻ᵀ A_gh,
// then A_hk ← A_hk − R_ghᵀ R_gk. Diagonal blocks that nothing couples are factored in parallel.
#include "mechanics/solver/band_cholesky.h"

#include <algorithm>
#include <cmath>

#include "kerf/parallel.h"
#include "mechanics/solver/band_lanes.h"

namespace geo {

BandCholesky::BandCholesky(const std::vector<std::size_t>& last)
    : last_(last), ranges_{0}, inverse_(6 * last.size(), 0) {
  std::size_t size = 0;
  for (std::size_t g = 0; g < last_.size(); ++g) {
    // Fill-in: elimination of the rows above extends a row to where they end.
    last_[g] = std::max(last_[g], g);
    if (g > ranges_.back()) last_[g] = std::max(last_[g], last_[g - 1]);
    if (last_[g] == g) ranges_.push_back(g + 1);
    begin_.push_back(size);
    stride_.push_back(length(g) + band_padding);
    size += 6 * stride_.back();
  }
  values_.assign(size, 0);
}

void BandCholesky::factor() {
  parallel_for(ranges_.size() - 1, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) factor(ranges_[k], ranges_[k + 1]);
  });
}

void BandCholesky::factor(std::size_t from, std::size_t to) {
  constexpr float rounding = 1e-5f;  // of a diagonal entry; a smaller pivot is rounding error of single precision
  std::vector<float> diagonal;
  for (std::size_t i = 6 * from; i < 6 * to; ++i) diagonal.push_back(at(i, i));
  for (std::size_t g = from; g < to; ++g) {
    float* const rows = tile_row(g);
    const std::size_t stride = stride_[g], n = length(g);
    float* const inverse = &inverse_[6 * g];
    // The diagonal tile, then the tiles right of it, then their outer product off the rows below.
    float upper[36] = {};
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = i; j < 6; ++j) {
        upper[6 * i + j] = rows[i * stride + j];
        for (std::size_t k = 0; k < i; ++k) upper[6 * i + j] -= upper[6 * k + i] * upper[6 * k + j];
      }
      const float pivot = upper[6 * i + i];
      inverse[i] = pivot > rounding * diagonal[6 * (g - from) + i] ? 1 / std::sqrt(pivot) : 0;
      for (std::size_t j = i; j < 6; ++j) rows[i * stride + j] = upper[6 * i + j] *= inverse[i];
    }
    eliminate_six(n - 6, stride, upper, inverse, rows + 6);
    for (std::size_t h = g + 1; h <= last_[g]; ++h) {
      const float* const right = rows + 6 * (h - g);
      float factor_tile[36];
      for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t k = 0; k < 6; ++k) factor_tile[6 * i + k] = right[k * stride + i];
      subtract_six(n - 6 * (h - g), factor_tile, stride, right, stride_[h], tile_row(h));
    }
  }
}

void BandCholesky::solve(float* x) const {
  parallel_for(ranges_.size() - 1, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      if (std::any_of(x + 6 * ranges_[k], x + 6 * ranges_[k + 1], [](float v) { return v != 0; }))
        solve(ranges_[k], ranges_[k + 1], x);
  });
}

void BandCholesky::solve(std::size_t from, std::size_t to, float* all) const {
  // In a copy, as vectors read and write beyond its end.
  std::vector<float> own(all + 6 * from, all + 6 * to);
  own.resize(own.size() + band_padding, 0.0f);
  for (std::size_t g = from; g < to; ++g) {
    const float *const rows = tile_row(g), *const inverse = &inverse_[6 * g];
    float* const x = &own[6 * (g - from)];
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t k = 0; k < i; ++k) x[i] -= rows[k * stride_[g] + i] * x[k];
      x[i] *= inverse[i];
    }
    subtract_rows(length(g) - 6, x, stride_[g], rows + 6, x + 6);
  }
  for (std::size_t g = to; g-- > from;) {
    const float *const rows = tile_row(g), *const inverse = &inverse_[6 * g];
    float* const x = &own[6 * (g - from)];
    float sums[6];
    dot_rows(length(g) - 6, stride_[g], rows + 6, x + 6, sums);
    for (std::size_t i = 6; i-- > 0;) {
      for (std::size_t k = i + 1; k < 6; ++k) sums[i] += rows[i * stride_[g] + k] * x[k];
      x[i] = inverse[i] * (x[i] - sums[i]);
    }
  }
  std::copy(own.begin(), own.end() - band_padding, all + 6 * from);
}

}  // namespace geo
