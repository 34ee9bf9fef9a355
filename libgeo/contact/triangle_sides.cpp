// Compiled once for each kind of vectors (see Highway's foreach_target.h); the processor's best is taken at run time. No sum is
// fused with a product, so that error bounds hold.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/triangle_sides.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "contact/keep_lanes.h"
#include "contact/triangle_sides.h"
#include "geometry/predicates.h"

HWY_BEFORE_NAMESPACE();
namespace geo {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;
using Corners = TriangleSides::Corners;
using Four = hn::CappedTag<double, 4>;
using V = hn::Vec<Four>;

// Whether all corners of o that p does not have are strictly on one side of p's plane: the determinant of orient3d_quick() with
// its bound, but taken relative to p's first corner.
HWY_INLINE bool on_one_side(const Corners& p, const Corners& o) {
  constexpr double bound_of_permanent = 7.771561172376103e-16;  // Shewchuk's A-stage, as there
  const Four d;
  bool above = true, below = true, all_shared = true;
  for (std::size_t k = 0; k < 4; k += hn::Lanes(d)) {
    const V row = hn::Load(d, o.row + k);
    const auto shared = hn::Or(hn::Eq(row, hn::Set(d, p.row[0])), hn::Or(hn::Eq(row, hn::Set(d, p.row[1])), hn::Eq(row, hn::Set(d, p.row[2]))));
    const V x = hn::Sub(hn::Load(d, o.at[0] + k), hn::Set(d, p.at[0][0]));
    const V y = hn::Sub(hn::Load(d, o.at[1] + k), hn::Set(d, p.at[1][0]));
    const V z = hn::Sub(hn::Load(d, o.at[2] + k), hn::Set(d, p.at[2][0]));
    const V det = hn::Add(hn::Add(hn::Mul(x, hn::Set(d, p.normal[0])), hn::Mul(y, hn::Set(d, p.normal[1]))), hn::Mul(z, hn::Set(d, p.normal[2])));
    const V permanent = hn::Add(hn::Add(hn::Mul(hn::Abs(x), hn::Set(d, p.terms[0])), hn::Mul(hn::Abs(y), hn::Set(d, p.terms[1]))), hn::Mul(hn::Abs(z), hn::Set(d, p.terms[2])));
    const V bound = hn::Mul(hn::Set(d, bound_of_permanent), permanent);
    const auto sure = hn::And(hn::Gt(permanent, hn::Set(d, filter_smallest)), hn::Lt(permanent, hn::Set(d, filter_largest)));
    above &= hn::AllTrue(d, hn::Or(shared, hn::And(sure, hn::Gt(det, bound))));
    below &= hn::AllTrue(d, hn::Or(shared, hn::And(sure, hn::Lt(det, hn::Neg(bound)))));
    all_shared &= hn::AllTrue(d, shared);
  }
  return (above | below) & !all_shared;
}

}  // namespace

std::size_t not_clear(const Corners* triangles, TriangleSides::Pair* pairs, std::size_t count) {
  return keep_pairs(pairs, count, [=](const TriangleSides::Pair& pair) HWY_ATTR {
    const Corners &s = triangles[pair.first], &t = triangles[pair.second];
    return !(on_one_side(s, t) || on_one_side(t, s));
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace geo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <cmath>

#include "base/parallel.h"

namespace geo {
HWY_EXPORT(not_clear);

TriangleSides::TriangleSides(std::span<const Triangle> triangles, std::span<const std::uint32_t> together, const std::vector<Vec3>& positions) : triangles_(triangles.size()) {
  parallel_for(triangles.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      Corners& one = triangles_[t];
      for (std::size_t k = 0; k < 4; ++k) {
        const auto row = together[triangles[t][std::min<std::size_t>(k, 2)]];
        one.row[k] = row;
        for (int axis = 0; axis < 3; ++axis) one.at[axis][k] = positions[row][axis];
      }
      const auto side = [&](int axis, int k) { return one.at[axis][k] - one.at[axis][0]; };
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double plus = side(j, 1) * side(k, 2), minus = side(k, 1) * side(j, 2);
        one.normal[i] = plus - minus, one.terms[i] = std::abs(plus) + std::abs(minus);
      }
    }
  });
}

void TriangleSides::keep_unclear(std::vector<Pair>& pairs) const { pairs.resize(HWY_DYNAMIC_DISPATCH(not_clear)(triangles_.data(), pairs.data(), pairs.size())); }

}  // namespace geo
#endif
