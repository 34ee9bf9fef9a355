// Compiled once for each kind of vector, like point_lanes.cpp.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/patch_lanes.cpp"
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_AVX3_DL)
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <algorithm>
#include <cmath>

#include "hwy/highway.h"
#include "mechanics/patch_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void OuterProducts(const PointBlock& block, const std::uint32_t* first, const NodePatches::Incidence* places, PatchParts& out) {
  using Four = hn::CappedTag<float, 4>;
  const Four d;
  constexpr std::size_t step = hn::MaxLanes(Four());
  struct Entry {
    std::uint32_t slot;
    const float* g;
  };
  std::vector<std::vector<Entry>> here(out.patches.size());
  std::vector<std::uint32_t> touched;
  for (std::size_t i = 0; i < block.points.size(); ++i) {
    const MaterialPoint& point = block.points[i];
    if (point.rung == Rung::rigid) continue;
    const float w = static_cast<float>(point.measured);
    for (std::size_t q = block.first[i]; q < block.first[i + 1]; ++q)
      for (auto k = first[block.to[q]]; k < first[block.to[q] + 1]; ++k) {
        auto& list = here[places[k].patch];
        if (list.empty()) touched.push_back(places[k].patch);
        list.push_back({places[k].slot, &block.rounded[3 * q]});
      }
    for (const auto p : touched) {
      auto& list = here[p];
      float* const tiles = &out.outer[out.first[p]];
      for (std::size_t a = 0; a < list.size(); ++a)
        for (std::size_t b = 0; b <= a; ++b) {  // entries of a point ascend, and so do slots
          const std::size_t s = list[a].slot, t = list[b].slot;
          float* const to = tiles + 12 * (s * (s + 1) / 2 + t);
          for (std::size_t k = 0; k < 4; k += step) {
            const auto g = hn::LoadU(d, list[b].g + k);
            for (std::size_t r = 0; r < 3; ++r) hn::StoreU(hn::MulAdd(hn::Set(d, w * list[a].g[r]), g, hn::LoadU(d, to + 4 * r + k)), d, to + 4 * r + k);
          }
        }
      if (list.size() > out.most[p].count) out.most[p] = {static_cast<std::uint32_t>(list.size()), static_cast<std::uint32_t>(i)};
      list.clear();
    }
    touched.clear();
  }
}

using Wide = hn::CappedTag<float, 16>;
constexpr std::size_t wide = hn::MaxLanes(Wide());

// With ones on the diagonal to begin with. Row k, divided by its pivot, has one more than the pivot's inverse at k while it is
// taken off the others: what these have there becomes what the inverse has, and no vector is read where a number was just written.
void InvertPositive(std::size_t size, float* matrix) {
  const Wide d;
  const std::size_t row = padded(size);
  std::vector<float> scale(row, 0.0f), by(size);
  for (std::size_t i = 0; i < size; ++i) scale[i] = 1 / std::sqrt(matrix[i * row + i]);
  const auto scale_all = [&]() HWY_ATTR {
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t j = 0; j < row; j += wide) hn::StoreU(hn::Mul(hn::Mul(hn::LoadU(d, &matrix[i * row + j]), hn::LoadU(d, &scale[j])), hn::Set(d, scale[i])), d, &matrix[i * row + j]);
  };
  scale_all();
  for (std::size_t k = 0; k < size; ++k) {
    float* const own = matrix + k * row;
    const float inverse = own[k] > 1e-5f ? 1 / own[k] : 0;
    for (std::size_t i = 0; i < size; ++i) by[i] = matrix[i * row + k];
    for (std::size_t j = 0; j < row; j += wide) hn::StoreU(hn::Mul(hn::LoadU(d, own + j), hn::Set(d, inverse)), d, own + j);
    own[k] = 1 + inverse;
    for (std::size_t j = 0; j < row; j += wide) {
      const auto of_row = hn::LoadU(d, own + j);
      const auto take = [&](std::size_t i) HWY_ATTR {
        float* const to = matrix + i * row + j;
        hn::StoreU(hn::NegMulAdd(hn::Set(d, by[i]), of_row, hn::LoadU(d, to)), d, to);
      };
      for (std::size_t i = 0; i < k; ++i) take(i);
      for (std::size_t i = k + 1; i < size; ++i) take(i);
    }
    own[k] = inverse;
  }
  scale_all();
}

void MultiplyHalves(std::size_t size, const std::uint16_t* matrix, const float* x, float* out) {
  const Wide d;
  const hn::Rebind<std::uint16_t, Wide> d16;
  const hn::RebindToUnsigned<Wide> d32;
  const std::size_t row = padded(size);
  const auto column = [&](std::size_t at) HWY_ATTR { return hn::BitCast(d, hn::ShiftLeft<16>(hn::PromoteTo(d32, hn::LoadU(d16, matrix + at)))); };
  std::size_t at = 0;
  for (; at + 2 * wide <= row; at += 2 * wide) {
    auto sum = hn::Zero(d), next = hn::Zero(d);
    for (std::size_t j = 0; j < size; ++j) {
      const auto by = hn::Set(d, x[j]);
      sum = hn::MulAdd(by, column(j * row + at), sum), next = hn::MulAdd(by, column(j * row + at + wide), next);
    }
    hn::StoreU(sum, d, out + at), hn::StoreU(next, d, out + at + wide);
  }
  for (; at < row; at += wide) {
    auto sum = hn::Zero(d);
    for (std::size_t j = 0; j < size; ++j) sum = hn::MulAdd(hn::Set(d, x[j]), column(j * row + at), sum);
    hn::StoreU(sum, d, out + at);
  }
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(OuterProducts);
HWY_EXPORT(InvertPositive);
HWY_EXPORT(MultiplyHalves);

void add_outer_products(const PointBlock& block, std::span<const std::uint32_t> first, std::span<const NodePatches::Incidence> places, PatchParts& out) {
  HWY_DYNAMIC_DISPATCH(OuterProducts)(block, first.data(), places.data(), out);
}
void invert_positive(std::size_t size, float* matrix) { HWY_DYNAMIC_DISPATCH(InvertPositive)(size, matrix); }
void multiply_halves(std::size_t size, const std::uint16_t* matrix, const float* x, float* out) { HWY_DYNAMIC_DISPATCH(MultiplyHalves)(size, matrix, x, out); }

}  // namespace geo
#endif
