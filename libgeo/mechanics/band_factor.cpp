#include "mechanics/band_factor.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "mechanics/coarse_lanes.h"

namespace geo {

BandFactor::BandFactor(const std::vector<std::size_t>& last) : last_(last), ranges_{0}, inverse_(6 * last.size(), 0) {
  std::size_t size = 0;
  for (std::size_t g = 0; g < last_.size(); ++g) {
    // What is left of a row while those above it are eliminated ends where they end.
    last_[g] = std::max(last_[g], g);
    if (g > ranges_.back()) last_[g] = std::max(last_[g], last_[g - 1]);
    if (last_[g] == g) ranges_.push_back(g + 1);
    for (std::size_t k = 0; k < 6; ++k) begin_.push_back(size), size += 6 * (last_[g] + 1) - (6 * g + k);
  }
  values_.assign(size, 0);
}

void BandFactor::factor() {
  parallel_for(ranges_.size() - 1, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) factor(ranges_[k], ranges_[k + 1]);
  });
}

void BandFactor::factor(std::size_t from, std::size_t to) {
  std::vector<float> diagonal;
  for (std::size_t i = 6 * from; i < 6 * to; ++i) diagonal.push_back(*row(i));
  for (std::size_t g = from; g < to; ++g) {
    const std::size_t end = 6 * (last_[g] + 1);
    for (std::size_t i = 6 * g; i < 6 * g + 6; ++i) {
      for (std::size_t k = 6 * g; k < i; ++k) subtract(end - i, row(k)[i - k], row(k) + (i - k), row(i));
      const float pivot = *row(i);
      inverse_[i] = pivot > 1e-5f * diagonal[i - 6 * from] ? 1 / std::sqrt(pivot) : 0;
      for (std::size_t j = i; j < end; ++j) row(i)[j - i] *= inverse_[i];
    }
    for (std::size_t i = 6 * g + 6; i < end; ++i) {
      float by[6];
      const float* rows[6];
      for (std::size_t k = 0; k < 6; ++k) rows[k] = row(6 * g + k) + (i - 6 * g - k), by[k] = *rows[k];
      subtract_six(end - i, by, rows, row(i));
    }
  }
}

void BandFactor::solve(float* x) const {
  parallel_for(ranges_.size() - 1, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      if (std::any_of(x + 6 * ranges_[k], x + 6 * ranges_[k + 1], [](float v) { return v != 0; })) solve(ranges_[k], ranges_[k + 1], x);
  });
}

void BandFactor::solve(std::size_t from, std::size_t to, float* x) const {
  for (std::size_t i = 6 * from; i < 6 * to; ++i) {
    x[i] *= inverse_[i];
    if (x[i] != 0) subtract(6 * (last_[i / 6] + 1) - i - 1, x[i], row(i) + 1, x + i + 1);
  }
  for (std::size_t i = 6 * to; i-- > 6 * from;) x[i] = inverse_[i] * (x[i] - dot(6 * (last_[i / 6] + 1) - i - 1, row(i) + 1, x + i + 1));
}

}  // namespace geo
