// det = n · (x − a) with n the cross product of two edges; its sign counts if |det| exceeds
// orient3d_error times the permanent (sum of absolute products, Shewchuk 1997).
//
// Compiled for each instruction set (base/simd_targets.h). Sums are never fused with products
// (-ffp-contract=off), so that the filter's error bound holds.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/orientation_lanes.cpp"
#include "base/simd_targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include <cmath>

#include "geometry/orientation_lanes.h"
#include "geometry/predicates.h"

HWY_BEFORE_NAMESPACE();
namespace geo {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, 8>;

template <class Mask>
HWY_INLINE std::uint64_t bits_of(const Mask& mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Doubles(), mask, bytes);
  return bytes[0];
}

}  // namespace

// The determinant and bound of orient3d_filtered(), with the first corner of the triangle as
// origin.
void orient_points(const double* corner, const double* normal, const double* permanents,
                   const double* const* coordinates, std::size_t words, std::uint64_t* above, std::uint64_t* below) {
  const Doubles d;
  for (std::size_t word = 0; word < words; ++word) {
    std::uint64_t over = 0, under = 0;
    for (std::size_t k = 0; k < 64; k += hn::Lanes(d)) {
      auto det = hn::Zero(d), permanent = det;
      for (int axis = 0; axis < 3; ++axis) {
        const auto x = hn::Sub(hn::LoadU(d, coordinates[axis] + 64 * word + k), hn::Set(d, corner[axis]));
        det = hn::Add(det, hn::Mul(x, hn::Set(d, normal[axis])));
        permanent = hn::Add(permanent, hn::Mul(hn::Abs(x), hn::Set(d, permanents[axis])));
      }
      const auto bound = hn::Mul(hn::Set(d, orient3d_error), permanent);
      const auto sure =
          hn::And(hn::Gt(permanent, hn::Set(d, filter_smallest)), hn::Lt(permanent, hn::Set(d, filter_largest)));
      over |= bits_of(hn::And(sure, hn::Gt(det, bound))) << k;
      under |= bits_of(hn::And(sure, hn::Lt(det, hn::Neg(bound)))) << k;
    }
    above[word] = over;
    below[word] = under;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace geo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(orient_points);

void filtered_orientations(const std::array<Vec3, 3>& triangle, const double* const* coordinates, std::size_t words,
                           std::uint64_t* above, std::uint64_t* below) {
  const Vec3 u = triangle[1] - triangle[0], v = triangle[2] - triangle[0];
  double normal[3], permanents[3];  // of the components of the cross product
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double plus = u[j] * v[k], minus = u[k] * v[j];
    normal[i] = plus - minus;
    permanents[i] = std::abs(plus) + std::abs(minus);
  }
  HWY_DYNAMIC_DISPATCH(orient_points)(triangle[0].data(), normal, permanents, coordinates, words, above, below);
}

}  // namespace geo
#endif
