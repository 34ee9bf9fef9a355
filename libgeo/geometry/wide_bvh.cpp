// Packets of up to 32 segments with a common end descend together. Tests in this order: boxes, slab
// of the triangle, filtered orientations in lanes, exact predicate for what is left.
// Compiled for each instruction set (base/simd_targets.h).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/wide_bvh.cpp"
#include "base/simd_targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include <bit>
#include <cmath>

#include "geometry/predicates.h"
#include "geometry/wide_bvh.h"

#ifndef KERF_WIDE_BVH_ONCE
#define KERF_WIDE_BVH_ONCE
namespace geo {
namespace {

constexpr std::size_t packet_size = 32;  // one bit a segment in a 32-bit mask

// Segments with a common end, in box coordinates.
struct Packet {
  float p[3];
  alignas(64) double exact_end[3][packet_size];  // in model coordinates
  alignas(64) float end[3][packet_size], lo[3][packet_size], hi[3][packet_size];
  float all_lo[3], all_hi[3];
  std::size_t count = 0;
  bool slabs_valid = true;  // all box coordinates are within [−2, 2]
};

// The plane through three points, for filtered orientations (Shewchuk's A-stage) of a fourth point.
struct Plane {
  Plane(const Vec3& origin, const Vec3& a, const Vec3& b) : origin(origin) {
    const Vec3 u = a - origin, v = b - origin;
    for (int i = 0; i < 3; ++i) {
      const double x = u[(i + 1) % 3] * v[(i + 2) % 3], y = u[(i + 2) % 3] * v[(i + 1) % 3];
      normal[i] = x - y;
      permanent[i] = std::abs(x) + std::abs(y);
    }
  }
  Vec3 origin;
  double normal[3], permanent[3];
};
constexpr double orientation_error = 0x1p-50;  // more than (7 + 56 ε) ε

using Corners = std::span<const std::array<Vec3, 3>>;
using Order = std::span<const std::uint32_t>;

}  // namespace
}  // namespace geo
#endif

HWY_BEFORE_NAMESPACE();
namespace geo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, WideBvh::width>;

template <class Mask>
std::uint32_t bits_of(const Mask& mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Floats(), mask, bytes);
  return bytes[0] | std::uint32_t(bytes[1]) << 8;
}

// The lanes of the boxes of a group that meet the box [lo, hi].
std::uint32_t meeting(const WideBvh::Boxes& boxes, const float* lo, const float* hi) {
  const Floats d;
  std::uint32_t bits = 0;
  for (std::size_t at = 0; at < WideBvh::width; at += hn::Lanes(d)) {
    auto mask = hn::Le(hn::Load(d, boxes.lo[0] + at), hn::Set(d, hi[0]));
    mask = hn::And(mask, hn::Ge(hn::Load(d, boxes.hi[0] + at), hn::Set(d, lo[0])));
    for (int axis = 1; axis < 3; ++axis) {
      mask = hn::And(mask, hn::Le(hn::Load(d, boxes.lo[axis] + at), hn::Set(d, hi[axis])));
      mask = hn::And(mask, hn::Ge(hn::Load(d, boxes.hi[axis] + at), hn::Set(d, lo[axis])));
    }
    bits |= bits_of(mask) << at;
  }
  return bits;
}

// The segments of a packet whose boxes meet one box of a group.
std::uint32_t meeting(const Packet& packet, const WideBvh::Boxes& boxes, std::uint32_t lane) {
  const Floats d;
  std::uint32_t bits = 0;
  for (std::size_t at = 0; at < packet.count; at += hn::Lanes(d)) {
    auto mask = hn::Ge(hn::Load(d, packet.hi[0] + at), hn::Set(d, boxes.lo[0][lane]));
    mask = hn::And(mask, hn::Le(hn::Load(d, packet.lo[0] + at), hn::Set(d, boxes.hi[0][lane])));
    for (int axis = 1; axis < 3; ++axis) {
      mask = hn::And(mask, hn::Ge(hn::Load(d, packet.hi[axis] + at), hn::Set(d, boxes.lo[axis][lane])));
      mask = hn::And(mask, hn::Le(hn::Load(d, packet.lo[axis] + at), hn::Set(d, boxes.hi[axis][lane])));
    }
    bits |= bits_of(mask) << at;
  }
  return bits;
}

// The segments of a packet that the slab of a triangle does not separate from it.
std::uint32_t within_slab(const Packet& packet, const WideBvh::Slabs& slabs, std::uint32_t lane) {
  const Floats d;
  const auto x = hn::Set(d, slabs.normal[0][lane]), y = hn::Set(d, slabs.normal[1][lane]),
             z = hn::Set(d, slabs.normal[2][lane]);
  const auto along = [&](const auto& px, const auto& py, const auto& pz) {
    return hn::Add(hn::Mul(x, px), hn::Add(hn::Mul(y, py), hn::Mul(z, pz)));
  };
  const auto p = along(hn::Set(d, packet.p[0]), hn::Set(d, packet.p[1]), hn::Set(d, packet.p[2]));
  const auto from = hn::Set(d, slabs.from[lane]), to = hn::Set(d, slabs.to[lane]);
  std::uint32_t apart = 0;
  for (std::size_t at = 0; at < packet.count; at += hn::Lanes(d)) {
    const auto q =
        along(hn::Load(d, packet.end[0] + at), hn::Load(d, packet.end[1] + at), hn::Load(d, packet.end[2] + at));
    apart |= bits_of(hn::Or(hn::Gt(hn::Min(p, q), to), hn::Lt(hn::Max(p, q), from))) << at;
  }
  return ~apart;
}

// Transforms the segments from p to `ends` to box coordinates. Unused lanes hold p itself.
void fill(const WideBvh& tree, const Vec3& p, const Vec3* ends, Packet& packet) {
  const hn::CappedTag<double, WideBvh::width> dd;
  const hn::Rebind<float, decltype(dd)> df;
  const std::size_t lanes = hn::Lanes(dd),
                    whole = (packet.count + WideBvh::width - 1) / WideBvh::width * WideBvh::width;
  auto& at = packet.exact_end;
  for (std::size_t s = 0; s < whole; ++s) {
    const double* const end = s < packet.count ? ends[s].data() : p.data();
    for (int axis = 0; axis < 3; ++axis) at[axis][s] = end[axis];
  }
  packet.slabs_valid = true;
  for (int axis = 0; axis < 3; ++axis) {
    packet.p[axis] = tree.local(p[axis], axis);
    const auto from = hn::Set(df, packet.p[axis]);
    auto all_lo = from, all_hi = from;
    for (std::size_t s = 0; s < whole; s += lanes) {
      const auto to = hn::DemoteTo(df, hn::Mul(hn::Sub(hn::Load(dd, at[axis] + s), hn::Set(dd, tree.middle()[axis])),
                                               hn::Set(dd, tree.scale())));
      const auto lo = hn::Min(from, to), hi = hn::Max(from, to);
      hn::Store(to, df, packet.end[axis] + s);
      hn::Store(lo, df, packet.lo[axis] + s);
      hn::Store(hi, df, packet.hi[axis] + s);
      all_lo = hn::Min(all_lo, lo);
      all_hi = hn::Max(all_hi, hi);
    }
    packet.all_lo[axis] = hn::GetLane(hn::MinOfLanes(df, all_lo));
    packet.all_hi[axis] = hn::GetLane(hn::MaxOfLanes(df, all_hi));
    packet.slabs_valid = packet.slabs_valid && packet.all_lo[axis] >= -2 && packet.all_hi[axis] <= 2;
  }
}

// The points that are certainly on the positive and on the negative side of a plane.
struct Sides {
  std::uint32_t positive, negative;
};
using Doubles = hn::CappedTag<double, 8>;
template <class V>
Sides sides(const Plane& plane, const V& x, const V& y, const V& z) {
  const Doubles d;
  const auto u = hn::Sub(x, hn::Set(d, plane.origin.x())), v = hn::Sub(y, hn::Set(d, plane.origin.y())),
             w = hn::Sub(z, hn::Set(d, plane.origin.z()));
  const auto sum = [&](const double* n, const auto& a, const auto& b, const auto& c) {
    return hn::Add(hn::Add(hn::Mul(hn::Set(d, n[0]), a), hn::Mul(hn::Set(d, n[1]), b)), hn::Mul(hn::Set(d, n[2]), c));
  };
  const auto value = sum(plane.normal, u, v, w), permanent = sum(plane.permanent, hn::Abs(u), hn::Abs(v), hn::Abs(w));
  const auto bound = hn::Mul(permanent, hn::Set(d, orientation_error));
  const auto valid =
      hn::And(hn::Gt(permanent, hn::Set(d, filter_smallest)), hn::Lt(permanent, hn::Set(d, filter_largest)));
  const auto bits = [&](const auto& mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, hn::And(mask, valid), bytes);
    return std::uint32_t(bytes[0]);
  };
  return {bits(hn::Gt(value, bound)), bits(hn::Lt(value, hn::Neg(bound)))};
}

// Segments that certainly pass through a triangle; segments that certainly do not touch it.
struct Crossing {
  std::uint32_t through, apart;
};
Crossing crossing(const Packet& packet, const Vec3& p, const std::array<Vec3, 3>& t, std::uint32_t segments) {
  const int side = orient3d_filtered(t[0], t[1], t[2], p);
  if (side == 2) return {0, 0};
  const Plane own(t[0], t[1], t[2]), edges[3] = {{p, t[0], t[1]}, {p, t[1], t[2]}, {p, t[2], t[0]}};
  const Doubles d;
  Crossing result{0, 0};
  for (std::size_t at = 0; at < packet.count; at += hn::Lanes(d)) {
    if ((segments >> at & ((1u << hn::Lanes(d)) - 1)) == 0) continue;
    const auto x = hn::Load(d, packet.exact_end[0] + at), y = hn::Load(d, packet.exact_end[1] + at),
               z = hn::Load(d, packet.exact_end[2] + at);
    const Sides end = sides(own, x, y, z);
    const Sides around[3] = {sides(edges[0], x, y, z), sides(edges[1], x, y, z), sides(edges[2], x, y, z)};
    const auto opposite = side > 0 ? end.negative : end.positive, same_side = side > 0 ? end.positive : end.negative;
    const auto all_positive = around[0].positive & around[1].positive & around[2].positive,
               all_negative = around[0].negative & around[1].negative & around[2].negative;
    const auto any_positive = around[0].positive | around[1].positive | around[2].positive,
               any_negative = around[0].negative | around[1].negative | around[2].negative;
    result.through |= (opposite & (all_positive | all_negative)) << at;
    result.apart |= (same_side | (opposite & any_positive & any_negative)) << at;
  }
  return {result.through & segments, result.apart & segments};
}

void blocked_packet(const WideBvh& tree, Corners corners, Order order, const Vec3& p, std::span<const Vec3> ends,
                    std::uint8_t* result) {
  Packet packet;
  packet.count = ends.size();
  fill(tree, p, ends.data(), packet);
  const auto& levels = tree.levels();
  struct Entry {
    std::uint32_t level, group;
  };
  Entry stack[8 * WideBvh::width];  // 2³² triangles have eight levels
  int top = 0;
  stack[top++] = {static_cast<std::uint32_t>(levels.size() - 1), 0};
  std::uint32_t undecided = packet.count == 32 ? ~0u : (1u << packet.count) - 1;
  while (top > 0 && undecided != 0) {
    const auto [level, group] = stack[--top];
    const auto& boxes = levels[level][group];
    for (auto lanes = meeting(boxes, packet.all_lo, packet.all_hi); lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes)), child = group * WideBvh::width + lane;
      if (level > 1) {
        stack[top++] = {level - 1, child};
        continue;
      }
      for (auto triangles = meeting(levels[0][child], packet.all_lo, packet.all_hi); triangles != 0 && undecided != 0;
           triangles &= triangles - 1) {
        const auto k = static_cast<std::uint32_t>(std::countr_zero(triangles));
        auto candidates = meeting(packet, levels[0][child], k) & undecided;
        if (candidates != 0 && packet.slabs_valid) candidates &= within_slab(packet, tree.slabs()[child], k);
        if (candidates == 0) continue;
        const auto& t = corners[order[child * WideBvh::width + k]];
        const Crossing certain = crossing(packet, p, t, candidates);
        auto blocked = certain.through;
        for (auto doubt = candidates & ~(certain.through | certain.apart); doubt != 0; doubt &= doubt - 1) {
          const auto s = static_cast<std::uint32_t>(std::countr_zero(doubt));
          if (segment_meets_triangle(p, ends[s], t[0], t[1], t[2])) blocked |= 1u << s;
        }
        undecided &= ~blocked;
        for (; blocked != 0; blocked &= blocked - 1) result[std::countr_zero(blocked)] = 1;
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace geo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(blocked_packet);

WideBvh::WideBvh(Corners corners, Order order) {
  if (order.empty()) return;
  Box3 box;
  for (const auto& t : corners) box.add(box_of(t[0], t[1], t[2]));
  middle_ = 0.5 * box.lo + 0.5 * box.hi;
  const double extent = (box.hi - middle_).cwiseMax(middle_ - box.lo).maxCoeff();
  // Smaller extents keep the scale 1: the reciprocal of a subnormal number overflows. All boxes
  // then meet at 0, and the exact predicate decides each segment. 1e-150 is far above these
  // numbers.
  if (extent > 1e-150) scale_ = 1 / extent;
  const auto empty_level = [](std::size_t count) {
    Boxes none;
    for (int axis = 0; axis < 3; ++axis)
      for (std::uint32_t lane = 0; lane < width; ++lane) {
        none.lo[axis][lane] = INFINITY;
        none.hi[axis][lane] = -INFINITY;
      }
    return std::vector<Boxes>((count + width - 1) / width, none);
  };
  // Error bound of slabs. Box coordinates of at most 2 have an error of 2⁻²³ (1 + 2⁻²⁸).
  // A dot product with a unit vector adds √3 times that, and 3 · 2⁻²⁴ · 2 √3 of its own rounding:
  // together less than 15 · 2⁻²⁴. Rounding of `from` and `to` adds 2⁻²³ at most.
  constexpr double margin = 0x1p-19;
  levels_.push_back(empty_level(order.size()));
  slabs_.resize(levels_[0].size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    Boxes& boxes = levels_[0][i / width];
    Slabs& slabs = slabs_[i / width];
    const auto lane = i % width;
    const auto& t = corners[order[i]];
    const Box3 b = box_of(t[0], t[1], t[2]);
    const Vec3 u = (t[1] - t[0]) * scale_, v = (t[2] - t[0]) * scale_;
    const Eigen::Vector3f normal = u.cross(v).stableNormalized().cast<float>();
    double from = INFINITY, to = -INFINITY;
    for (const Vec3& corner : t) {
      const double along = normal.cast<double>().dot((corner - middle_) * scale_);
      from = std::min(from, along);
      to = std::max(to, along);
    }
    for (int axis = 0; axis < 3; ++axis) {
      boxes.lo[axis][lane] = local(b.lo[axis], axis);
      boxes.hi[axis][lane] = local(b.hi[axis], axis);
      slabs.normal[axis][lane] = normal[axis];
    }
    slabs.from[lane] = static_cast<float>(from - margin);
    slabs.to[lane] = static_cast<float>(to + margin);
  }
  while (levels_.size() < 2 || levels_.back().size() > 1) {
    const auto& below = levels_.back();
    auto level = empty_level(below.size());
    for (std::size_t i = 0; i < below.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) {
        level[i / width].lo[axis][i % width] = *std::min_element(below[i].lo[axis], below[i].lo[axis] + width);
        level[i / width].hi[axis][i % width] = *std::max_element(below[i].hi[axis], below[i].hi[axis] + width);
      }
    levels_.push_back(std::move(level));
  }
}

void WideBvh::blocked(Corners corners, Order order, const Vec3& p, std::span<const Vec3> ends,
                      std::uint8_t* result) const {
  std::fill_n(result, ends.size(), std::uint8_t(0));
  add_blocked(corners, order, p, ends, result);
}

void WideBvh::remove(std::uint32_t place) {
  for (int axis = 0; axis < 3; ++axis) {
    levels_[0][place / width].lo[axis][place % width] = INFINITY;
    levels_[0][place / width].hi[axis][place % width] = -INFINITY;
  }
}

void WideBvh::add_blocked(Corners corners, Order order, const Vec3& p, std::span<const Vec3> ends,
                          std::uint8_t* result) const {
  if (levels_.empty()) return;
  for (std::size_t first = 0; first < ends.size(); first += packet_size) HWY_DYNAMIC_DISPATCH(blocked_packet)
  (*this, corners, order, p, ends.subspan(first, std::min(packet_size, ends.size() - first)), result + first);
}

}  // namespace geo
#endif
