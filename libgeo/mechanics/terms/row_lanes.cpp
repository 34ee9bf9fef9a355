// Compiled once for each kind of vector, like point_lanes.cpp. No sum is fused with a product, so all give the same.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/terms/row_lanes.cpp"
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_AVX3_DL)
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <algorithm>

#include "hwy/highway.h"
#include "mechanics/terms/row_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void SumRows(const std::span<const NodeWeight> (&rows)[rows_together], const FourNumbers* values,
             FourNumbers (&sums)[rows_together]) {
  using Tag = hn::CappedTag<double, 4>;
  const Tag d;
  constexpr std::size_t step = hn::MaxLanes(Tag());
  std::size_t least = rows[0].size();
  for (const auto& row : rows) least = std::min(least, row.size());
  for (std::size_t at = 0; at < 4; at += step) {
    hn::Vec<Tag> sum[rows_together];
    for (auto& s : sum) s = hn::Zero(d);
    const auto add = [&](std::size_t r, std::size_t k) HWY_ATTR {
      const NodeWeight& e = rows[r][k];
      sum[r] = hn::Add(sum[r], hn::Mul(hn::Set(d, e.weight), hn::Load(d, values[e.node].at + at)));
    };
    for (std::size_t k = 0; k < least; ++k)
      for (std::size_t r = 0; r < rows_together; ++r) add(r, k);
    for (std::size_t r = 0; r < rows_together; ++r) {
      for (std::size_t k = least; k < rows[r].size(); ++k) add(r, k);
      hn::Store(sum[r], d, sums[r].at + at);
    }
  }
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(SumRows);

void sum_rows(const std::span<const NodeWeight> (&rows)[rows_together], const FourNumbers* values,
              FourNumbers (&sums)[rows_together]) {
  HWY_DYNAMIC_DISPATCH(SumRows)(rows, values, sums);
}

}  // namespace geo
#endif
