// Compiled once for each kind of vector, like point_lanes.cpp. No sum is fused with a product, so
// all give the same.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/discretisation/node_lanes.cpp"
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_AVX3_DL)
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include "hwy/highway.h"
#include "mechanics/discretisation/node_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<double, 4>;
constexpr std::size_t step = hn::MaxLanes(Tag());

void RowGradient(const std::uint32_t* to, std::size_t count, const Vec3* g, const PaddedVec3* values, std::uint32_t own,
                 FourColumns& out) {
  const Tag d;
  for (std::size_t at = 0; at < 4; at += step) {
    const auto self = hn::Load(d, values[own].at + at);
    auto x = hn::Zero(d), y = x, z = x;
    for (std::size_t q = 0; q < count; ++q) {
      const auto apart = hn::Sub(hn::Load(d, values[to[q]].at + at), self);
      x = hn::Add(x, hn::Mul(apart, hn::Set(d, g[q][0])));
      y = hn::Add(y, hn::Mul(apart, hn::Set(d, g[q][1])));
      z = hn::Add(z, hn::Mul(apart, hn::Set(d, g[q][2])));
    }
    hn::Store(x, d, out.at[0] + at), hn::Store(y, d, out.at[1] + at), hn::Store(z, d, out.at[2] + at);
  }
}

void MovedBy(const std::uint32_t* to, std::size_t count, const MovedNodes& nodes, std::uint32_t own, PaddedVec3& out) {
  const Tag d;
  const double* const x = nodes.place[own].at;
  for (std::size_t at = 0; at < 4; at += step) {
    auto sum = hn::Load(d, nodes.displacement[own].at + at);
    double total = 1;  // of the kernel without its scale: the node itself is at distance zero
    for (std::size_t q = 0; q < count; ++q) {
      const double* const from = nodes.place[to[q]].at;
      const double way[3] = {x[0] - from[0], x[1] - from[1], x[2] - from[2]};
      const double left = 1 - (way[0] * way[0] + way[1] * way[1] + way[2] * way[2]) * from[3];
      if (!(left > 0)) continue;
      const double w = left * left * left;
      const auto& slope = nodes.gradient[to[q]].at;
      auto there = hn::Load(d, nodes.displacement[to[q]].at + at);
      for (std::size_t c = 0; c < 3; ++c)
        there = hn::Add(there, hn::Mul(hn::Load(d, slope[c] + at), hn::Set(d, way[c])));
      total += w, sum = hn::Add(sum, hn::Mul(hn::Set(d, w), there));
    }
    hn::Store(hn::Div(sum, hn::Set(d, total)), d, out.at + at);
  }
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(RowGradient);
HWY_EXPORT(MovedBy);

FourColumns row_gradient(std::span<const std::uint32_t> to, const Vec3* g, const PaddedVec3* values,
                         std::uint32_t own) {
  FourColumns result;
  HWY_DYNAMIC_DISPATCH(RowGradient)(to.data(), to.size(), g, values, own, result);
  return result;
}

PaddedVec3 moved_by(std::span<const std::uint32_t> to, const MovedNodes& nodes, std::uint32_t own) {
  PaddedVec3 result;
  HWY_DYNAMIC_DISPATCH(MovedBy)(to.data(), to.size(), nodes, own, result);
  return result;
}

}  // namespace geo
#endif
