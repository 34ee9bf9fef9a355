// Compiled once for each kind of vector, like point_lanes.cpp. Product and sum are one operation, where the processor has it,
// only in the loop over pairs of slots.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/coarse_lanes.cpp"
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_AVX3_DL)
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <algorithm>

#include "hwy/highway.h"
#include "mechanics/coarse_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void RigidStiffness(const PointBlock& block, const StiffnessModes& modes, const float* weight, const Moduli* moduli, std::size_t stride, const std::uint16_t* slot,
                    std::size_t slots, const float* arm, float* out) {
  using Four = hn::CappedTag<float, 4>;
  using Eight = hn::CappedTag<float, 8>;
  const Four d4;
  const Eight d8;
  constexpr std::size_t step = hn::MaxLanes(Eight());
  std::vector<float> moment, strain, stress;  // per slot of a point: three rows of (Σ arm g, Σ g); six rows of eight modes
  std::vector<std::uint32_t> here;
  std::vector<std::uint32_t> place(slots, ~0u);
  for (std::size_t i = 0; i < block.points.size(); i += stride) {
    const float w = static_cast<float>(stride) * weight[i];
    if (!(w > 0)) continue;
    const auto [shear, bulk] = moduli[block.points[i].material];
    here.clear(), moment.clear();
    for (std::size_t q = block.first[i]; q < block.first[i + 1]; ++q) {
      const std::uint32_t s = slot[block.to[q]];
      if (place[s] == ~0u) place[s] = static_cast<std::uint32_t>(here.size()), here.push_back(s), moment.resize(moment.size() + 12, 0.0f);
      float* const m = &moment[12 * place[s]];
      const float* const at = arm + 4 * block.to[q];
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t k = 0; k < 4; k += hn::MaxLanes(Four()))
          hn::StoreU(hn::Add(hn::LoadU(d4, m + 4 * c + k), hn::Mul(hn::Set(d4, block.rounded[3 * q + c]), hn::LoadU(d4, at + k))), d4, m + 4 * c + k);
    }
    const Eigen::Matrix3f rotation = modes.rotation(i);
    const auto r = [&](std::size_t column) { return rotation.data() + 3 * column; };
    strain.assign(tile * here.size(), 0.0f), stress.assign(tile * here.size(), 0.0f);
    for (std::size_t s = 0; s < here.size(); ++s) {
      // Row (a, b) of the gradient in the rotated frame, by modes: translations r_a g_b, rotations m_b × r_a.
      const float* const m = &moment[12 * s];
      float* const e = &strain[tile * s];
      constexpr std::size_t row[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b) {
          float* const to = e + 8 * row[a][b];
          const float* const mb = m + 4 * b;
          for (std::size_t k = 0; k < 3; ++k) to[k] += r(a)[k] * mb[3];
          for (std::size_t k = 0; k < 3; ++k) to[3 + k] += mb[(k + 1) % 3] * r(a)[(k + 2) % 3] - mb[(k + 2) % 3] * r(a)[(k + 1) % 3];
        }
      float* const f = &stress[tile * s];
      for (std::size_t k = 0; k < 6; ++k) {
        const float trace = bulk * (e[k] + e[8 + k] + e[16 + k]);
        for (std::size_t q = 0; q < 3; ++q) f[8 * q + k] = w * (2 * shear * e[8 * q + k] + trace), f[24 + 8 * q + k] = w * shear * e[24 + 8 * q + k];
      }
    }
    for (std::size_t s = 0; s < here.size(); ++s)
      for (std::size_t t = 0; t < here.size(); ++t) {
        if (here[t] > here[s]) continue;
        float* const to = out + tile * (here[s] * (here[s] + 1) / 2 + here[t]);
        const float *const f = &stress[tile * s], *const e = &strain[tile * t];
        for (std::size_t k = 0; k < 8; k += step) {
          const auto e0 = hn::LoadU(d8, e + k), e1 = hn::LoadU(d8, e + 8 + k), e2 = hn::LoadU(d8, e + 16 + k);
          const auto e3 = hn::LoadU(d8, e + 24 + k), e4 = hn::LoadU(d8, e + 32 + k), e5 = hn::LoadU(d8, e + 40 + k);
          for (std::size_t m = 0; m < 6; ++m) {
            auto sum = hn::LoadU(d8, to + 8 * m + k);
            sum = hn::MulAdd(hn::Set(d8, f[8 + m]), e1, hn::MulAdd(hn::Set(d8, f[m]), e0, sum));
            sum = hn::MulAdd(hn::Set(d8, f[24 + m]), e3, hn::MulAdd(hn::Set(d8, f[16 + m]), e2, sum));
            sum = hn::MulAdd(hn::Set(d8, f[40 + m]), e5, hn::MulAdd(hn::Set(d8, f[32 + m]), e4, sum));
            hn::StoreU(sum, d8, to + 8 * m + k);
          }
        }
      }
    for (const auto s : here) place[s] = ~0u;
  }
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(RigidStiffness);

void rigid_stiffness(const PointBlock& block, const StiffnessModes& modes, const std::vector<float>& weight, std::span<const Moduli> moduli, std::size_t stride,
                     std::span<const std::uint16_t> slot, const float* arm, float* out) {
  const std::size_t slots = slot.empty() ? 0 : std::size_t(*std::max_element(slot.begin(), slot.end())) + 1;
  HWY_DYNAMIC_DISPATCH(RigidStiffness)(block, modes, weight.data(), moduli.data(), stride, slot.data(), slots, arm, out);
}

}  // namespace geo
#endif
