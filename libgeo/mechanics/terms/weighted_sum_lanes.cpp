// Compiled for each instruction set (base/simd_targets.h). Products and sums are not fused
// (-ffp-contract=off), so all give the same bits.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/terms/weighted_sum_lanes.cpp"
#include "base/simd_targets.h"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <algorithm>

#include "hwy/highway.h"
#include "mechanics/terms/weighted_sum_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void WeightedSums(const Stencil (&stencils)[stencils_per_batch], const PaddedVec3* values,
                  PaddedVec3 (&sums)[stencils_per_batch]) {
  using Tag = hn::CappedTag<double, 4>;
  const Tag d;
  constexpr std::size_t lanes = hn::MaxLanes(Tag());
  std::size_t shortest = stencils[0].size();
  for (const auto& stencil : stencils) shortest = std::min(shortest, stencil.size());
  for (std::size_t axis = 0; axis < 4; axis += lanes) {
    hn::Vec<Tag> sum[stencils_per_batch];
    for (auto& s : sum) s = hn::Zero(d);
    const auto add = [&](std::size_t s, std::size_t k) HWY_ATTR {
      const NodeWeight& e = stencils[s][k];
      sum[s] = hn::Add(sum[s], hn::Mul(hn::Set(d, e.weight), hn::Load(d, values[e.node].at + axis)));
    };
    for (std::size_t k = 0; k < shortest; ++k)
      for (std::size_t s = 0; s < stencils_per_batch; ++s) add(s, k);
    for (std::size_t s = 0; s < stencils_per_batch; ++s) {
      for (std::size_t k = shortest; k < stencils[s].size(); ++k) add(s, k);
      hn::Store(sum[s], d, sums[s].at + axis);
    }
  }
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(WeightedSums);

void weighted_sums(const Stencil (&stencils)[stencils_per_batch], const PaddedVec3* values,
                   PaddedVec3 (&sums)[stencils_per_batch]) {
  HWY_DYNAMIC_DISPATCH(WeightedSums)(stencils, values, sums);
}

}  // namespace geo
#endif
