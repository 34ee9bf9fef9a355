// Compiled for each instruction set (base/simd_targets.h). Products and sums are not fused
// (-ffp-contract=off), so that all give the same numbers.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/solver/band_lanes.cpp"
#include "base/simd_targets.h"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include "hwy/highway.h"
#include "mechanics/solver/band_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Wide = hn::CappedTag<float, band_padding>;
constexpr std::size_t wide = hn::MaxLanes(Wide());

void EliminateSix(std::size_t n, std::size_t stride, const float* HWY_RESTRICT upper, const float* HWY_RESTRICT inverse,
                  float* HWY_RESTRICT rows) {
  const Wide d;
  for (std::size_t j = 0; j < n; j += wide) {
    hn::Vec<Wide> row[6];
    for (std::size_t i = 0; i < 6; ++i) {
      row[i] = hn::LoadU(d, rows + i * stride + j);
      for (std::size_t k = 0; k < i; ++k) row[i] = hn::Sub(row[i], hn::Mul(hn::Set(d, upper[6 * k + i]), row[k]));
      row[i] = hn::Mul(row[i], hn::Set(d, inverse[i]));
      hn::StoreU(row[i], d, rows + i * stride + j);
    }
  }
}

void SubtractSix(std::size_t n, const float* HWY_RESTRICT factor, std::size_t other_stride,
                 const float* HWY_RESTRICT other, std::size_t stride, float* HWY_RESTRICT rows) {
  const Wide d;
  for (std::size_t j = 0; j < n; j += wide) {
    hn::Vec<Wide> row[6];
    for (std::size_t k = 0; k < 6; ++k) row[k] = hn::LoadU(d, other + k * other_stride + j);
    for (std::size_t i = 0; i < 6; ++i) {
      auto sum = hn::LoadU(d, rows + i * stride + j);
      for (std::size_t k = 0; k < 6; ++k) sum = hn::Sub(sum, hn::Mul(hn::Set(d, factor[6 * i + k]), row[k]));
      hn::StoreU(sum, d, rows + i * stride + j);
    }
  }
}

void SubtractRows(std::size_t n, const float* HWY_RESTRICT factor, std::size_t stride, const float* HWY_RESTRICT rows,
                  float* HWY_RESTRICT x) {
  const Wide d;
  for (std::size_t j = 0; j < n; j += wide) {
    auto sum = hn::LoadU(d, x + j);
    for (std::size_t k = 0; k < 6; ++k)
      sum = hn::Sub(sum, hn::Mul(hn::Set(d, factor[k]), hn::LoadU(d, rows + k * stride + j)));
    hn::StoreU(sum, d, x + j);
  }
}

void DotRows(std::size_t n, std::size_t stride, const float* HWY_RESTRICT rows, const float* HWY_RESTRICT x,
             float* HWY_RESTRICT out) {
  const Wide d;
  HWY_ALIGN float sums[6][band_padding];
  for (std::size_t at = 0; at < band_padding; at += wide) {
    hn::Vec<Wide> sum[6];
    for (auto& s : sum) s = hn::Zero(d);
    for (std::size_t j = at; j < n + at; j += band_padding) {
      const auto xs = hn::LoadU(d, x + j);
      for (std::size_t k = 0; k < 6; ++k) sum[k] = hn::Add(sum[k], hn::Mul(hn::LoadU(d, rows + k * stride + j), xs));
    }
    for (std::size_t k = 0; k < 6; ++k) hn::StoreU(sum[k], d, sums[k] + at);
  }
  for (std::size_t k = 0; k < 6; ++k) {
    for (std::size_t half = band_padding / 2; half > 0; half /= 2)
      for (std::size_t i = 0; i < half; ++i) sums[k][i] += sums[k][i + half];
    out[k] = sums[k][0];
  }
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(EliminateSix);
HWY_EXPORT(SubtractSix);
HWY_EXPORT(SubtractRows);
HWY_EXPORT(DotRows);

void eliminate_six(std::size_t n, std::size_t stride, const float* upper, const float* inverse, float* rows) {
  HWY_DYNAMIC_DISPATCH(EliminateSix)(n, stride, upper, inverse, rows);
}
void subtract_six(std::size_t n, const float* factor, std::size_t other_stride, const float* other, std::size_t stride,
                  float* rows) {
  HWY_DYNAMIC_DISPATCH(SubtractSix)(n, factor, other_stride, other, stride, rows);
}
void subtract_rows(std::size_t n, const float* factor, std::size_t stride, const float* rows, float* x) {
  HWY_DYNAMIC_DISPATCH(SubtractRows)(n, factor, stride, rows, x);
}
void dot_rows(std::size_t n, std::size_t stride, const float* rows, const float* x, float* out) {
  HWY_DYNAMIC_DISPATCH(DotRows)(n, stride, rows, x, out);
}

}  // namespace geo
#endif
