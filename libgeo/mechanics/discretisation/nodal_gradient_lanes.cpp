// Compiled for each instruction set (base/simd_targets.h). Products and sums are not fused
// (-ffp-contract=off), so all give the same bits.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/discretisation/nodal_gradient_lanes.cpp"
#include "base/simd_targets.h"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include "hwy/highway.h"
#include "mechanics/discretisation/nodal_gradient_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<double, 4>;
constexpr std::size_t lanes = hn::MaxLanes(Tag());

void MlsGradient(std::span<const std::uint32_t> neighbors, const Vec3* g, const PaddedVec3* values, std::uint32_t node,
                 PaddedMat3& out) {
  const Tag d;
  for (std::size_t axis = 0; axis < 4; axis += lanes) {
    const auto own = hn::Load(d, values[node].at + axis);
    auto x = hn::Zero(d), y = x, z = x;
    for (std::size_t q = 0; q < neighbors.size(); ++q) {
      const auto difference = hn::Sub(hn::Load(d, values[neighbors[q]].at + axis), own);
      x = hn::Add(x, hn::Mul(difference, hn::Set(d, g[q][0])));
      y = hn::Add(y, hn::Mul(difference, hn::Set(d, g[q][1])));
      z = hn::Add(z, hn::Mul(difference, hn::Set(d, g[q][2])));
    }
    hn::Store(x, d, out.at[0] + axis);
    hn::Store(y, d, out.at[1] + axis);
    hn::Store(z, d, out.at[2] + axis);
  }
}

void BlendedDisplacement(std::span<const std::uint32_t> neighbors, const AffineNodes& nodes, std::uint32_t node,
                         PaddedVec3& out) {
  const Tag d;
  const double* const x = nodes.place[node].at;
  for (std::size_t axis = 0; axis < 4; axis += lanes) {
    auto sum = hn::Load(d, nodes.displacement[node].at + axis);
    double total = 1;  // the node's own weight: the kernel without its scale, at distance zero
    for (const std::uint32_t j : neighbors) {
      const double* const from = nodes.place[j].at;
      const double offset[3] = {x[0] - from[0], x[1] - from[1], x[2] - from[2]};
      const double root = 1 - (offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2]) * from[3];
      if (!(root > 0)) continue;
      const double w = root * root * root;
      const auto& gradient = nodes.gradient[j].at;
      auto displacement = hn::Load(d, nodes.displacement[j].at + axis);
      for (std::size_t c = 0; c < 3; ++c)
        displacement = hn::Add(displacement, hn::Mul(hn::Load(d, gradient[c] + axis), hn::Set(d, offset[c])));
      total += w;
      sum = hn::Add(sum, hn::Mul(hn::Set(d, w), displacement));
    }
    hn::Store(hn::Div(sum, hn::Set(d, total)), d, out.at + axis);
  }
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(MlsGradient);
HWY_EXPORT(BlendedDisplacement);

PaddedMat3 mls_gradient(std::span<const std::uint32_t> neighbors, const Vec3* g, const PaddedVec3* values,
                        std::uint32_t node) {
  PaddedMat3 result;
  HWY_DYNAMIC_DISPATCH(MlsGradient)(neighbors, g, values, node, result);
  return result;
}

PaddedVec3 blended_displacement(std::span<const std::uint32_t> neighbors, const AffineNodes& nodes,
                                std::uint32_t node) {
  PaddedVec3 result;
  HWY_DYNAMIC_DISPATCH(BlendedDisplacement)(neighbors, nodes, node, result);
  return result;
}

}  // namespace geo
#endif
