// Support intervals along the start normal n of triangle p. Triangle o is separated above if
// min n · o − max n · p exceeds the bound at both ends of the motion; below, likewise.
//
// Compiled for each instruction set (base/simd_targets.h). Sums are never fused with products
// (-ffp-contract=off), so that all give the same results.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/detection/triangle_planes.cpp"
#include "base/simd_targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "contact/detection/compact_pairs_lanes.h"
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

// n · corner, for the corners from k on.
HWY_INLINE V products(const double (&n)[3], const double (&at)[3][4], std::size_t k) {
  const Four d;
  return hn::Add(
      hn::Add(hn::Mul(hn::Set(d, n[0]), hn::Load(d, at[0] + k)), hn::Mul(hn::Set(d, n[1]), hn::Load(d, at[1] + k))),
      hn::Mul(hn::Set(d, n[2]), hn::Load(d, at[2] + k)));
}

HWY_INLINE double least(const double (&n)[3], const double (&at)[3][4]) {
  const Four d;
  V v = products(n, at, 0);
  for (std::size_t k = hn::Lanes(d); k < 4; k += hn::Lanes(d)) v = hn::Min(v, products(n, at, k));
  return hn::GetLane(hn::MinOfLanes(d, v));
}
HWY_INLINE double most(const double (&n)[3], const double (&at)[3][4]) {
  const Four d;
  V v = products(n, at, 0);
  for (std::size_t k = hn::Lanes(d); k < 4; k += hn::Lanes(d)) v = hn::Max(v, products(n, at, k));
  return hn::GetLane(hn::MaxOfLanes(d, v));
}

// Whether the plane of p separates o from p. Without branches, since the side is hard to predict.
HWY_INLINE bool plane_separates(const Plane& p, const Plane& o, double start, double end) {
  const Four d;
  bool above = true, below = true;
  for (std::size_t k = 0; k < 4; k += hn::Lanes(d)) {
    const V at_start = products(p.normal, o.at[0], k), at_end = products(p.normal, o.at[1], k),
            least_start = hn::Set(d, start), least_end = hn::Set(d, end);
    const auto over = hn::And(hn::Gt(hn::Sub(at_start, hn::Set(d, p.high[0])), least_start),
                              hn::Gt(hn::Sub(at_end, hn::Set(d, p.high[1])), least_end));
    const auto under = hn::And(hn::Gt(hn::Sub(hn::Set(d, p.low[0]), at_start), least_start),
                               hn::Gt(hn::Sub(hn::Set(d, p.low[1]), at_end), least_end));
    above &= hn::AllTrue(d, over);
    below &= hn::AllTrue(d, under);
  }
  return above | below;
}

// The separation by the plane of p at the end, on the side of p where o's centroid is at the start:
// n · Σ o > 3 (low + high) / 2.
HWY_INLINE double end_separation(const Plane& p, const Plane& o) {
  double sum[3];
  for (int axis = 0; axis < 3; ++axis) sum[axis] = o.at[0][axis][0] + o.at[0][axis][1] + o.at[0][axis][2];
  const double at_start = p.normal[0] * sum[0] + p.normal[1] * sum[1] + p.normal[2] * sum[2];
  return at_start > 1.5 * (p.low[0] + p.high[0]) ? least(p.normal, o.at[1]) - p.high[1]
                                                 : p.low[1] - most(p.normal, o.at[1]);
}

// Separations along n = difference of centroids, unnormalised: bounds are multiplied by |n|.
HWY_INLINE bool centroids_separate(const Plane& p, const Plane& o, double start, double end) {
  const double n[3] = {p.centroid[0] - o.centroid[0], p.centroid[1] - o.centroid[1], p.centroid[2] - o.centroid[2]};
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  return least(n, p.at[0]) - most(n, o.at[0]) > start * length && least(n, p.at[1]) - most(n, o.at[1]) > end * length;
}

}  // namespace

bool planes_separate(const Plane& p, const Plane& o, double start, double end) {
  return plane_separates(p, o, start, end) | plane_separates(o, p, start, end);
}

std::size_t compact_by_planes(const Plane* planes, Pair* pairs, std::size_t count, double start, double end) {
  return compact_pairs(pairs, count, [=](const Pair& pair) HWY_ATTR {
    return !planes_separate(planes[pair.first], planes[pair.second], start, end);
  });
}

std::size_t compact_by_centroids(const Plane* planes, Pair* pairs, std::size_t count, double start, double end) {
  return compact_pairs(pairs, count, [=](const Pair& pair) HWY_ATTR {
    return !centroids_separate(planes[pair.first], planes[pair.second], start, end);
  });
}

void find_end_separations(const Plane* planes, const Pair* pairs, std::size_t count, double* separations) {
  for (std::size_t i = 0; i < count; ++i) {
    const Plane &p = planes[pairs[i].first], &o = planes[pairs[i].second];
    separations[i] = std::max(end_separation(p, o), end_separation(o, p));
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
HWY_EXPORT(planes_separate);
HWY_EXPORT(compact_by_planes);
HWY_EXPORT(compact_by_centroids);
HWY_EXPORT(find_end_separations);

void TrianglePlanes::compute(std::span<const Triangle> triangles, const std::vector<Vec3>& from,
                             const std::vector<Vec3>& to) {
  triangles_ = triangles;
  to_ = &to;
  // An eighth to spare: the number of triangles grows with each step of a cut. Memory that is never
  // written costs nothing.
  if (planes_.size() < triangles.size()) {
    planes_ = {};
    planes_ = UninitializedArray<Plane>(triangles.size() + triangles.size() / 8);
  }
  parallel_for(triangles.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      Plane& p = planes_[t];
      const Vec3 &a = from[triangles_[t][0]], &b = from[triangles_[t][1]], &c = from[triangles_[t][2]];
      Vec3 n = (b - a).cross(c - a);
      if (const double length = n.norm(); length > 0) n /= length;
      const Vec3 centroid = (a + b + c) / 3;
      for (int axis = 0; axis < 3; ++axis) {
        p.normal[axis] = n[axis];
        p.centroid[axis] = centroid[axis];
        p.at[0][axis][0] = a[axis];
        p.at[0][axis][1] = b[axis];
        p.at[0][axis][2] = p.at[0][axis][3] = c[axis];
      }
      const double x = n.dot(a), y = n.dot(b), z = n.dot(c);
      p.low[0] = std::min({x, y, z});
      p.high[0] = std::max({x, y, z});
      update_end(t);
    }
  });
}

void TrianglePlanes::update_end(std::size_t i) {
  Plane& p = planes_[i];
  const Vec3 n(p.normal[0], p.normal[1], p.normal[2]), &a = (*to_)[triangles_[i][0]], &b = (*to_)[triangles_[i][1]],
                                                       &c = (*to_)[triangles_[i][2]];
  for (int axis = 0; axis < 3; ++axis) {
    p.at[1][axis][0] = a[axis];
    p.at[1][axis][1] = b[axis];
    p.at[1][axis][2] = p.at[1][axis][3] = c[axis];
  }
  const double x = n.dot(a), y = n.dot(b), z = n.dot(c);
  p.low[1] = std::min({x, y, z});
  p.high[1] = std::max({x, y, z});
}

bool TrianglePlanes::separates(std::uint32_t i, std::uint32_t j, double start, double end) const {
  return HWY_DYNAMIC_DISPATCH(planes_separate)(planes_[i], planes_[j], start, end);
}

void TrianglePlanes::remove_separated(std::vector<Pair>& pairs, double start, double end) const {
  pairs.resize(HWY_DYNAMIC_DISPATCH(compact_by_planes)(planes_.data(), pairs.data(), pairs.size(), start, end));
}

void TrianglePlanes::remove_centroid_separated(std::vector<Pair>& pairs, double start, double end) const {
  pairs.resize(HWY_DYNAMIC_DISPATCH(compact_by_centroids)(planes_.data(), pairs.data(), pairs.size(), start, end));
}

std::vector<double> TrianglePlanes::end_separations(std::span<const Pair> pairs) const {
  std::vector<double> result(pairs.size());
  HWY_DYNAMIC_DISPATCH(find_end_separations)(planes_.data(), pairs.data(), pairs.size(), result.data());
  return result;
}

}  // namespace geo
#endif
