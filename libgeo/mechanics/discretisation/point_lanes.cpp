// Each lane has its own sum. MulAdd is one operation on all targets that have it (simd_targets.h):
// these give the same bits, others differ by rounding. Add of Mul, as in AddKernelWeighted, is two
// operations on every target (-ffp-contract=off): the same bits on all.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/discretisation/point_lanes.cpp"
#include "base/simd_targets.h"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <algorithm>

#include "hwy/highway.h"
#include "mechanics/discretisation/point_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Column c of a point's gradient: the sum of its nodes' values, each times coordinate c of its
// shape gradient.
void Gradients(const PointBlock& block, const double* values, double* const* out) {
  using Tag = hn::CappedTag<double, 4>;
  const Tag d;
  constexpr std::size_t lanes = hn::MaxLanes(Tag());
  const std::uint16_t* node = block.entry_node.data();
  const double* g = block.entry_gradient.data();
  for (std::size_t i = 0; i < block.points.size(); ++i) {
    const std::size_t begin = block.entry_begin[i], end = block.entry_begin[i + 1];
    for (std::size_t axis = 0; axis < 4; axis += lanes) {
      auto x = hn::Zero(d), y = x, z = x;
      for (std::size_t q = begin; q < end; ++q) {
        const auto u = hn::LoadU(d, values + 4 * node[q] + axis);
        x = hn::MulAdd(u, hn::Set(d, g[3 * q]), x);
        y = hn::MulAdd(u, hn::Set(d, g[3 * q + 1]), y);
        z = hn::MulAdd(u, hn::Set(d, g[3 * q + 2]), z);
      }
      hn::StoreU(x, d, out[0] + 4 * i + axis);
      hn::StoreU(y, d, out[1] + 4 * i + axis);
      hn::StoreU(z, d, out[2] + 4 * i + axis);
    }
  }
}

void Divergence(const PointBlock& block, const double* const* stress, double* out) {
  using Tag = hn::CappedTag<double, 4>;
  const Tag d;
  constexpr std::size_t lanes = hn::MaxLanes(Tag());
  const std::uint16_t* node = block.entry_node.data();
  const double* g = block.entry_gradient.data();
  for (std::size_t i = 0; i < block.points.size(); ++i) {
    const std::size_t begin = block.entry_begin[i], end = block.entry_begin[i + 1];
    for (std::size_t axis = 0; axis < 4; axis += lanes) {
      const auto x = hn::LoadU(d, stress[0] + 4 * i + axis), y = hn::LoadU(d, stress[1] + 4 * i + axis),
                 z = hn::LoadU(d, stress[2] + 4 * i + axis);
      for (std::size_t q = begin; q < end; ++q) {
        double* const f = out + 4 * node[q] + axis;
        hn::StoreU(
            hn::MulAdd(z, hn::Set(d, g[3 * q + 2]),
                       hn::MulAdd(y, hn::Set(d, g[3 * q + 1]), hn::MulAdd(x, hn::Set(d, g[3 * q]), hn::LoadU(d, f)))),
            d, f);
      }
    }
  }
}

void AddKernelWeighted(const PointBlock& block, const Vec3& base, const float* HWY_RESTRICT place,
                       const float* HWY_RESTRICT numbers, float* HWY_RESTRICT out) {
  using Tag = hn::CappedTag<float, 8>;
  const Tag d;
  constexpr std::size_t lanes = hn::MaxLanes(Tag());
  const std::uint16_t* node = block.entry_node.data();
  for (std::size_t i = 0; i < block.points.size(); ++i) {
    if (numbers[8 * i + 6] == 0) continue;
    const Vec3 from = block.points[i].position - base;
    const auto x0 = static_cast<float>(from[0]), y0 = static_cast<float>(from[1]), z0 = static_cast<float>(from[2]),
               volume = static_cast<float>(block.points[i].volume);
    for (std::size_t q = block.entry_begin[i]; q < block.entry_begin[i + 1]; ++q) {
      const float* const at = place + 4 * node[q];
      const float x = x0 - at[0], y = y0 - at[1], z = z0 - at[2];
      const float root = 1 - (x * x + y * y + z * z) * at[3];  // its cube is the kernel without its scale
      if (!(root > 0)) continue;
      const auto w = hn::Set(d, volume * root * root * root);
      float* const sum = out + 8 * node[q];
      for (std::size_t c = 0; c < 8; c += lanes)
        hn::StoreU(hn::Add(hn::LoadU(d, sum + c), hn::Mul(w, hn::LoadU(d, numbers + 8 * i + c))), d, sum + c);
    }
  }
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(Gradients);
HWY_EXPORT(Divergence);
HWY_EXPORT(AddKernelWeighted);

void point_gradients(const PointBlock& block, const double* values, PointMatrices<double>& out) {
  out.resize(block.points.size());
  double* const columns[3] = {out.column[0].data(), out.column[1].data(), out.column[2].data()};
  HWY_DYNAMIC_DISPATCH(Gradients)(block, values, columns);
}
void point_divergence(const PointBlock& block, const PointMatrices<double>& stress, double* out) {
  const double* const columns[3] = {stress.column[0].data(), stress.column[1].data(), stress.column[2].data()};
  HWY_DYNAMIC_DISPATCH(Divergence)(block, columns, out);
}
void add_kernel_weighted(const PointBlock& block, const Vec3& base, const float* place, const float* numbers,
                         float* out) {
  HWY_DYNAMIC_DISPATCH(AddKernelWeighted)(block, base, place, numbers, out);
}

}  // namespace geo
#endif
