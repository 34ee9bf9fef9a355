// Compiled once for each kind of vector, like point_lanes.cpp, and with the same numbers for all.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/product_lanes.cpp"
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_AVX3_DL)
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <algorithm>

#include "hwy/highway.h"
#include "mechanics/matrix_lanes.h"
#include "mechanics/product_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {

// Entries of a point are taken in turn by two sums, whatever the vectors' width. Shape gradients are read as the upper halves of 32 bits.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void gradients(const PointBlock& block, std::size_t from, std::size_t end_point, const float* values, float* const* out) {
  for (std::size_t i = from; i < end_point; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t r = 0; r < 3; ++r) {
        float sums[2] = {0, 0};
        for (std::size_t q = block.first[i]; q < block.first[i + 1]; ++q)
          sums[(q - block.first[i]) % 2] += values[4 * std::size_t(block.to[q]) + r] * (65536.0f * block.packed[4 * q + c]);
        out[c][4 * (i - from) + r] = sums[0] + sums[1];
      }
}
HWY_INLINE void divergence(const PointBlock& block, std::size_t from, std::size_t end_point, const float* const* stress, float* out) {
  for (std::size_t i = from; i < end_point; ++i)
    for (std::size_t q = block.first[i]; q < block.first[i + 1]; ++q)
      for (std::size_t r = 0; r < 3; ++r) {
        const auto part = [&](std::size_t c) { return stress[c][4 * (i - from) + r] * (65536.0f * block.packed[4 * q + c]); };
        out[4 * std::size_t(block.to[q]) + r] += part(0) + part(1) + part(2);
      }
}
#else
// One or two entries side by side, the coordinates of each in four lanes.
template <class Wide>
struct Spread {
  using Bytes = hn::Repartition<std::uint8_t, Wide>;
  hn::Vec<Bytes> at[3];
  HWY_INLINE Spread() {
    HWY_ALIGN std::uint8_t order[32];
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t k = 0; k < 8; ++k) {
        order[4 * k] = order[4 * k + 1] = 0x80;
        for (std::size_t b = 0; b < 2; ++b) order[4 * k + 2 + b] = static_cast<std::uint8_t>(8 * (k / 4) + 2 * c + b);
      }
      at[c] = hn::LoadU(Bytes(), order);
    }
  }
  HWY_INLINE hn::Vec<Bytes> entries(const PointBlock& block, std::size_t q) const {
    return hn::BitCast(Bytes(), hn::LoadDup128(hn::Repartition<std::int16_t, Wide>(), block.packed.data() + 4 * q));
  }
  /// Coordinate c of entries, times 2¹⁶.
  HWY_INLINE hn::Vec<Wide> operator()(hn::Vec<Bytes> entries, std::size_t c) const {
    return hn::ConvertTo(Wide(), hn::BitCast(hn::Rebind<std::int32_t, Wide>(), hn::TableLookupBytesOr0(entries, at[c])));
  }
};

// Of the node's numbers, which are by fours, for entry q.
HWY_INLINE std::size_t place_of(const PointBlock& block, std::size_t q) { return 4 * std::size_t(static_cast<std::uint16_t>(block.packed[4 * q + 3])); }

template <class Wide = hn::CappedTag<float, 8>>
HWY_INLINE void gradients(const PointBlock& block, std::size_t from, std::size_t end_point, const float* values, float* const* out) {
  constexpr std::size_t beside = hn::MaxLanes(Wide()) / 4;
  const Wide d;
  const hn::CappedTag<float, 4> d4;
  const Spread<Wide> spread;
  for (std::size_t i = from; i < end_point; ++i) {
    hn::Vec<Wide> sum[2 / beside][3];
    for (auto& s : sum)
      for (auto& x : s) x = hn::Zero(d);
    const std::size_t end = block.first[i + 1];
    const auto add = [&](hn::Vec<Wide>* to_sum, std::size_t q, hn::Vec<Wide> u) HWY_ATTR {
      const auto g = spread.entries(block, q);
      for (std::size_t c = 0; c < 3; ++c) to_sum[c] = hn::Add(to_sum[c], hn::Mul(u, spread(g, c)));
    };
    std::size_t q = block.first[i];
    if constexpr (beside == 2) {
      for (; q + 2 <= end; q += 2) add(sum[0], q, hn::Combine(d, hn::LoadU(d4, values + place_of(block, q + 1)), hn::LoadU(d4, values + place_of(block, q))));
      if (q < end) add(sum[0], q, hn::ZeroExtendVector(d, hn::LoadU(d4, values + place_of(block, q))));
      for (std::size_t c = 0; c < 3; ++c) hn::StoreU(hn::Add(hn::LowerHalf(d4, sum[0][c]), hn::UpperHalf(d4, sum[0][c])), d4, out[c] + 4 * (i - from));
    } else {
      for (; q + 2 <= end; q += 2) add(sum[0], q, hn::LoadU(d, values + place_of(block, q))), add(sum[1], q + 1, hn::LoadU(d, values + place_of(block, q + 1)));
      if (q < end) add(sum[0], q, hn::LoadU(d, values + place_of(block, q)));
      for (std::size_t c = 0; c < 3; ++c) hn::StoreU(hn::Add(sum[0][c], sum[1][c]), d, out[c] + 4 * (i - from));
    }
  }
}

template <class Wide = hn::CappedTag<float, 8>>
HWY_INLINE void divergence(const PointBlock& block, std::size_t from, std::size_t end_point, const float* const* stress, float* out) {
  constexpr std::size_t beside = hn::MaxLanes(Wide()) / 4;
  const Wide d;
  const hn::CappedTag<float, 4> d4;
  const Spread<Wide> spread;
  for (std::size_t i = from; i < end_point; ++i) {
    hn::Vec<Wide> s[3];
    for (std::size_t c = 0; c < 3; ++c) s[c] = hn::LoadDup128(d, stress[c] + 4 * (i - from));
    const auto part = [&](std::size_t q) HWY_ATTR {
      const auto g = spread.entries(block, q);
      return hn::Add(hn::Add(hn::Mul(s[0], spread(g, 0)), hn::Mul(s[1], spread(g, 1))), hn::Mul(s[2], spread(g, 2)));
    };
    const auto add = [&](std::size_t q, hn::Vec<decltype(d4)> f) HWY_ATTR {
      float* const at = out + place_of(block, q);
      hn::StoreU(hn::Add(hn::LoadU(d4, at), f), d4, at);
    };
    std::size_t q = block.first[i];
    const std::size_t end = block.first[i + 1];
    if constexpr (beside == 2) {
      for (; q + 2 <= end; q += 2) {
        const auto f = part(q);
        add(q, hn::LowerHalf(d4, f)), add(q + 1, hn::UpperHalf(d4, f));
      }
      if (q < end) add(q, hn::LowerHalf(d4, part(q)));
    } else {
      for (; q < end; ++q) add(q, part(q));
    }
  }
}
#endif

// Gradients of points from `first` on, in multiples of their unit, become the stresses that belong to them, times it.
HWY_INLINE void apply_modes(const PointBlock& block, const StiffnessModes& modes, std::size_t first, std::size_t count, float* const* gradient) {
  const Lanes<float> d;
  const hn::Rebind<std::int32_t, Lanes<float>> d32;
  const hn::Rebind<std::int16_t, Lanes<float>> d16;
  for (std::size_t i = 0; i < count; i += width<float>) {
    const std::int16_t* const in_frame = &modes.frame[modes.number(first + i, 18)];
    const float* const stiffness = &modes.stiffness[modes.number(first + i, 12)];
    const auto frame = [&](std::size_t k) HWY_ATTR { return hn::ConvertTo(d, hn::PromoteTo(d32, hn::LoadU(d16, in_frame + 8 * k))); };
    const auto number = [&](std::size_t k) HWY_ATTR { return hn::LoadU(d, stiffness + 8 * k); };
    Matrix<float> u, v;
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t r = 0; r < 3; ++r) u.at[c][r] = frame(3 * c + r), v.at[c][r] = frame(9 + 3 * c + r);
    const auto unit = hn::Mul(hn::LoadU(d, block.unit.data() + first + i), hn::Set(d, 1 / (65536 * StiffnessModes::full * StiffnessModes::full)));
    Matrix<float> in = product(transposed(u), product(load(gradient, i), v)), out;
    for (auto& column : in.at)
      for (auto& x : column) x = hn::Mul(x, unit);
    const V<float> a[3][3] = {{number(0), number(3), number(4)}, {number(3), number(1), number(5)}, {number(4), number(5), number(2)}};
    for (int k = 0; k < 3; ++k) out.at[k][k] = hn::Add(hn::Add(hn::Mul(a[k][0], in.at[0][0]), hn::Mul(a[k][1], in.at[1][1])), hn::Mul(a[k][2], in.at[2][2]));
    for (std::size_t k = 0; k < 3; ++k) {
      const int p = k == 2 ? 1 : 0, q = k == 0 ? 1 : 2;
      const auto own = number(6 + 2 * k), other = number(7 + 2 * k);
      out.at[p][q] = hn::Add(hn::Mul(own, in.at[p][q]), hn::Mul(other, in.at[q][p]));
      out.at[q][p] = hn::Add(hn::Mul(own, in.at[q][p]), hn::Mul(other, in.at[p][q]));
    }
    for (auto& column : out.at)
      for (auto& x : column) x = hn::Mul(x, unit);
    store(product(product(u, out), transposed(v)), gradient, i);
  }
}

// A few points at a time, so that what is between the three steps stays at hand.
void Stiffness(const PointBlock& block, const StiffnessModes& modes, const float* values, float* out) {
  constexpr std::size_t batch = 16;
  HWY_ALIGN float numbers[3][4 * batch] = {};
  float* const columns[3] = {numbers[0], numbers[1], numbers[2]};
  for (std::size_t i = 0; i < block.points.size(); i += batch) {
    const std::size_t end = std::min(i + batch, block.points.size());
    gradients(block, i, end, values, columns);
    apply_modes(block, modes, i, std::min(batch, modes.points - i), columns);
    divergence(block, i, end, columns, out);
  }
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(Stiffness);

void multiply_stiffness(const PointBlock& block, const StiffnessModes& modes, const float* values, float* out) { HWY_DYNAMIC_DISPATCH(Stiffness)(block, modes, values, out); }

}  // namespace geo
#endif
