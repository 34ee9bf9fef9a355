// Pᵀ K P of a block's points: strains of each aggregate's rigid motions, their stresses, and the
// products of both. Compiled for each instruction set (base/simd_targets.h). Products and sums are
// fused only in the loop over pairs of slots, by MulAdd.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/solver/coarse_lanes.cpp"
#include "base/simd_targets.h"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <algorithm>

#include "hwy/cache_control.h"
#include "hwy/highway.h"
#include "mechanics/solver/coarse_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Eight = hn::CappedTag<float, 8>;
constexpr std::size_t eight = hn::MaxLanes(Eight());

// Six rows (xx yy zz xy xz yz) of eight modes: strains of a slot's rigid motions, and their
// stresses. `moment`: three columns Σ arm g, g times the arm_numbers(); `turn`: the rotation's
// columns in the same layout.
HWY_INLINE void strain_and_stress(const float* HWY_RESTRICT moment, const float* HWY_RESTRICT turn, float w,
                                  const Moduli& moduli, float* HWY_RESTRICT strain, float* HWY_RESTRICT stress) {
  const Eight d;
  const auto twice = hn::Set(d, 2 * moduli.shear), bulk = hn::Set(d, moduli.bulk), weight = hn::Set(d, w),
             weighted = hn::Set(d, w * moduli.shear);
  for (std::size_t k = 0; k < 8; k += eight) {
    // Entry (a, b) of the gradient in the rotated frame, of all modes: translations r_a g_b,
    // rotations (m_b × r_a).
    const auto entry = [&](std::size_t a, std::size_t b) HWY_ATTR {
      const float *const r = turn + 16 * a + k, *const m = moment + 16 * b + k;
      return hn::Sub(hn::Mul(hn::LoadU(d, m), hn::LoadU(d, r)), hn::Mul(hn::LoadU(d, m + 8), hn::LoadU(d, r + 8)));
    };
    const hn::Vec<Eight> normal[3] = {entry(0, 0), entry(1, 1), entry(2, 2)},
                         shear[3] = {hn::Add(entry(0, 1), entry(1, 0)), hn::Add(entry(0, 2), entry(2, 0)),
                                     hn::Add(entry(1, 2), entry(2, 1))};
    const auto trace = hn::Mul(bulk, hn::Add(hn::Add(normal[0], normal[1]), normal[2]));
    for (std::size_t q = 0; q < 3; ++q) {
      hn::StoreU(normal[q], d, strain + 8 * q + k);
      hn::StoreU(shear[q], d, strain + 24 + 8 * q + k);
      hn::StoreU(hn::Mul(weight, hn::Add(hn::Mul(twice, normal[q]), trace)), d, stress + 8 * q + k);
      hn::StoreU(hn::Mul(weighted, shear[q]), d, stress + 24 + 8 * q + k);
    }
  }
}

void RigidStiffness(const CorotatedPoints& points, const std::uint16_t* slot, std::size_t slots, const float* arm,
                    float* out) {
  const auto& [block, modes, weights, all_moduli, stride] = points;
  const float* const weight = weights.data();
  const Moduli* const moduli = all_moduli.data();
  const Eight d8;
  using Wide = hn::CappedTag<float, 16>;
  const Wide d;
  std::vector<float> moments(48 * slots, 0.0f), strain(tile * slots),
      stress(tile * slots);  // moments: per slot of the block, all zero between points; the others: per slot of a point
  std::vector<std::uint32_t> here(slots + 1);
  std::vector<std::uint8_t> is_here(slots, 0);
  for (std::size_t i = 0; i < block.points.size(); i += stride) {
    // The hardware does not prefetch points that are `stride` apart.
    if (const std::size_t ahead = i + 2 * stride; ahead < block.points.size()) {
      for (std::size_t q = 3 * block.entry_begin[ahead]; q < 3 * block.entry_begin[ahead + 1]; q += 16)
        hwy::Prefetch(&block.entry_gradient_single[q]);
      for (std::size_t k = 0; k < 18; k += 4) hwy::Prefetch(&modes.frame[modes.offset(ahead, 18) + 8 * k]);
    }
    const float w = static_cast<float>(stride) * weight[i];
    if (!(w > 0)) continue;
    std::size_t count = 0;
    const std::uint16_t* const to = block.entry_node.data();
    for (std::size_t q = block.entry_begin[i], last = block.entry_begin[i + 1]; q < last; ++q) {
      const std::uint32_t s = slot[to[q]];
      here[count] = s;
      count += !is_here[s];
      is_here[s] = 1;
      float* const m = &moments[48 * s];
      const float *const at = arm + 16 * to[q], *const g = &block.entry_gradient_single[3 * q];
      for (std::size_t k = 0; k < 16; k += hn::MaxLanes(d)) {
        const auto of_node = hn::LoadU(d, at + k);
        for (std::size_t c = 0; c < 3; ++c)
          hn::StoreU(hn::Add(hn::LoadU(d, m + 16 * c + k), hn::Mul(hn::Set(d, g[c]), of_node)), d, m + 16 * c + k);
      }
    }
    const Eigen::Matrix3f rotation = modes.rotation(i);
    float turn[48] = {};
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < 4; ++k) {
        const float* const column = rotation.data() + 3 * c;
        turn[16 * c + k] = column[k % 3];
        turn[16 * c + 4 + k] = column[(k + 2) % 3];
        turn[16 * c + 12 + k] = column[(k + 1) % 3];
      }
    for (std::size_t s = 0; s < count; ++s) {
      float* const m = &moments[48 * here[s]];
      strain_and_stress(m, turn, w, moduli[block.points[i].material], &strain[tile * s], &stress[tile * s]);
      for (std::size_t k = 0; k < 48; k += hn::MaxLanes(d)) hn::StoreU(hn::Zero(d), d, m + k);
      is_here[here[s]] = 0;
    }
    for (std::size_t s = 0; s < count; ++s)
      for (std::size_t t = 0; t < count; ++t) {
        if (here[t] > here[s]) continue;
        float* const to = out + tile * (here[s] * (here[s] + 1) / 2 + here[t]);
        const float *const f = &stress[tile * s], *const e = &strain[tile * t];
        for (std::size_t k = 0; k < 8; k += eight) {
          const auto e0 = hn::LoadU(d8, e + k), e1 = hn::LoadU(d8, e + 8 + k), e2 = hn::LoadU(d8, e + 16 + k);
          const auto e3 = hn::LoadU(d8, e + 24 + k), e4 = hn::LoadU(d8, e + 32 + k), e5 = hn::LoadU(d8, e + 40 + k);
          for (std::size_t m = 0; m < 6; ++m) {
            const float* const by = f + mode_at(m);
            auto sum = hn::LoadU(d8, to + 8 * m + k);
            sum = hn::MulAdd(hn::Set(d8, by[8]), e1, hn::MulAdd(hn::Set(d8, by[0]), e0, sum));
            sum = hn::MulAdd(hn::Set(d8, by[24]), e3, hn::MulAdd(hn::Set(d8, by[16]), e2, sum));
            sum = hn::MulAdd(hn::Set(d8, by[40]), e5, hn::MulAdd(hn::Set(d8, by[32]), e4, sum));
            hn::StoreU(sum, d8, to + 8 * m + k);
          }
        }
      }
  }
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(RigidStiffness);

void rigid_stiffness(const CorotatedPoints& points, std::span<const std::uint16_t> slot, const float* arm, float* out) {
  const std::size_t slots = slot.empty() ? 0 : std::size_t(*std::max_element(slot.begin(), slot.end())) + 1;
  HWY_DYNAMIC_DISPATCH(RigidStiffness)(points, slot.data(), slots, arm, out);
}

}  // namespace geo
#endif
