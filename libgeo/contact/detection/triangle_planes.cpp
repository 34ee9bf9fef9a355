// Compiled once for each kind of vectors (see Highway's foreach_target.h); the processor's best is taken at run time.
// No sum is fused with a product, so all give the same.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/detection/triangle_planes.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "contact/detection/keep_lanes.h"
#include "contact/detection/triangle_planes.h"

HWY_BEFORE_NAMESPACE();
namespace geo {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;
using Plane = TrianglePlanes::Plane;
using Pair = TrianglePlanes::Pair;
using Four = hn::CappedTag<double, 4>;
using V = hn::Vec<Four>;

// Corners k and on along n.
HWY_INLINE V along(const double (&n)[3], const double (&at)[3][4], std::size_t k) {
  const Four d;
  return hn::Add(
      hn::Add(hn::Mul(hn::Set(d, n[0]), hn::Load(d, at[0] + k)), hn::Mul(hn::Set(d, n[1]), hn::Load(d, at[1] + k))),
      hn::Mul(hn::Set(d, n[2]), hn::Load(d, at[2] + k)));
}

HWY_INLINE double least(const double (&n)[3], const double (&at)[3][4]) {
  const Four d;
  V v = along(n, at, 0);
  for (std::size_t k = hn::Lanes(d); k < 4; k += hn::Lanes(d)) v = hn::Min(v, along(n, at, k));
  return hn::GetLane(hn::MinOfLanes(d, v));
}
HWY_INLINE double most(const double (&n)[3], const double (&at)[3][4]) {
  const Four d;
  V v = along(n, at, 0);
  for (std::size_t k = hn::Lanes(d); k < 4; k += hn::Lanes(d)) v = hn::Max(v, along(n, at, k));
  return hn::GetLane(hn::MaxOfLanes(d, v));
}

// Without branches, as which side it is cannot be foretold.
HWY_INLINE bool parts(const Plane& p, const Plane& o, double first, double last) {
  const Four d;
  bool above = true, below = true;
  for (std::size_t k = 0; k < 4; k += hn::Lanes(d)) {
    const V begin = along(p.normal, o.at[0], k), end = along(p.normal, o.at[1], k), least_first = hn::Set(d, first),
            least_last = hn::Set(d, last);
    const auto over = hn::And(hn::Gt(hn::Sub(begin, hn::Set(d, p.high[0])), least_first),
                              hn::Gt(hn::Sub(end, hn::Set(d, p.high[1])), least_last));
    const auto under = hn::And(hn::Gt(hn::Sub(hn::Set(d, p.low[0]), begin), least_first),
                               hn::Gt(hn::Sub(hn::Set(d, p.low[1]), end), least_last));
    above &= hn::AllTrue(d, over), below &= hn::AllTrue(d, under);
  }
  return above | below;
}

HWY_INLINE double left_by(const Plane& p, const Plane& o) {
  double sum[3];
  for (int axis = 0; axis < 3; ++axis) sum[axis] = o.at[0][axis][0] + o.at[0][axis][1] + o.at[0][axis][2];
  const double beginning = p.normal[0] * sum[0] + p.normal[1] * sum[1] + p.normal[2] * sum[2];
  return beginning > 1.5 * (p.low[0] + p.high[0]) ? least(p.normal, o.at[1]) - p.high[1]
                                                  : p.low[1] - most(p.normal, o.at[1]);
}

HWY_INLINE bool parted_across(const Plane& p, const Plane& o, double first, double last) {
  const double n[3] = {p.middle[0] - o.middle[0], p.middle[1] - o.middle[1], p.middle[2] - o.middle[2]};
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  return least(n, p.at[0]) - most(n, o.at[0]) > first * length && least(n, p.at[1]) - most(n, o.at[1]) > last * length;
}

}  // namespace

bool planes_part(const Plane& p, const Plane& o, double first, double last) {
  return parts(p, o, first, last) | parts(o, p, first, last);
}

std::size_t not_parted(const Plane* planes, Pair* pairs, std::size_t count, double first, double last) {
  return keep_pairs(pairs, count, [=](const Pair& pair) HWY_ATTR {
    return !planes_part(planes[pair.first], planes[pair.second], first, last);
  });
}

std::size_t not_parted_across(const Plane* planes, Pair* pairs, std::size_t count, double first, double last) {
  return keep_pairs(pairs, count, [=](const Pair& pair) HWY_ATTR {
    return !parted_across(planes[pair.first], planes[pair.second], first, last);
  });
}

void ways_left(const Plane* planes, const Pair* pairs, std::size_t count, double* left) {
  for (std::size_t i = 0; i < count; ++i) {
    const Plane &p = planes[pairs[i].first], &o = planes[pairs[i].second];
    left[i] = std::max(left_by(p, o), left_by(o, p));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace geo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <cmath>

#include "kerf/parallel.h"

namespace geo {
HWY_EXPORT(planes_part);
HWY_EXPORT(not_parted);
HWY_EXPORT(not_parted_across);
HWY_EXPORT(ways_left);

void TrianglePlanes::place(std::span<const Triangle> triangles, const std::vector<Vec3>& from,
                           const std::vector<Vec3>& to) {
  triangles_ = triangles, to_ = &to;
  // Where a surface is cut, triangles become more step by step; the system gives memory where it is written to.
  if (planes_.size() < triangles.size())
    planes_ = {}, planes_ = UninitializedArray<Plane>(triangles.size() + triangles.size() / 8);
  parallel_for(triangles.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      Plane& p = planes_[t];
      const Vec3 &a = from[triangles_[t][0]], &b = from[triangles_[t][1]], &c = from[triangles_[t][2]];
      Vec3 n = (b - a).cross(c - a);
      if (const double length = n.norm(); length > 0) n /= length;
      const Vec3 middle = (a + b + c) / 3;
      for (int axis = 0; axis < 3; ++axis) {
        p.normal[axis] = n[axis], p.middle[axis] = middle[axis];
        p.at[0][axis][0] = a[axis], p.at[0][axis][1] = b[axis], p.at[0][axis][2] = p.at[0][axis][3] = c[axis];
      }
      const double x = n.dot(a), y = n.dot(b), z = n.dot(c);
      p.low[0] = std::min({x, y, z}), p.high[0] = std::max({x, y, z});
      renew_end(t);
    }
  });
}

void TrianglePlanes::renew_end(std::size_t i) {
  Plane& p = planes_[i];
  const Vec3 n(p.normal[0], p.normal[1], p.normal[2]), &a = (*to_)[triangles_[i][0]], &b = (*to_)[triangles_[i][1]],
                                                       &c = (*to_)[triangles_[i][2]];
  for (int axis = 0; axis < 3; ++axis)
    p.at[1][axis][0] = a[axis], p.at[1][axis][1] = b[axis], p.at[1][axis][2] = p.at[1][axis][3] = c[axis];
  const double x = n.dot(a), y = n.dot(b), z = n.dot(c);
  p.low[1] = std::min({x, y, z}), p.high[1] = std::max({x, y, z});
}

bool TrianglePlanes::part(std::uint32_t i, std::uint32_t j, double first, double last) const {
  return HWY_DYNAMIC_DISPATCH(planes_part)(planes_[i], planes_[j], first, last);
}

void TrianglePlanes::keep_unparted(std::vector<Pair>& pairs, double first, double last) const {
  pairs.resize(HWY_DYNAMIC_DISPATCH(not_parted)(planes_.data(), pairs.data(), pairs.size(), first, last));
}

void TrianglePlanes::keep_unparted_across(std::vector<Pair>& pairs, double first, double last) const {
  pairs.resize(HWY_DYNAMIC_DISPATCH(not_parted_across)(planes_.data(), pairs.data(), pairs.size(), first, last));
}

std::vector<double> TrianglePlanes::left(std::span<const Pair> pairs) const {
  std::vector<double> result(pairs.size());
  HWY_DYNAMIC_DISPATCH(ways_left)(planes_.data(), pairs.data(), pairs.size(), result.data());
  return result;
}

}  // namespace geo
#endif
