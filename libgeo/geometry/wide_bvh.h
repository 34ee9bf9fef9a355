// A 16-wide bounding volume hierarchy for packets of up to 32 short segments with a common end, in
// SIMD lanes. Part of TriangleBvh (bvh.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// A tree of boxes over triangles, in groups of sixteen boxes. Boxes are floats in box coordinates,
/// in which the triangles' coordinates are at most 1 in magnitude. The transformation to box
/// coordinates is monotone, rounding included: boxes that meet still meet there. Exact predicates
/// decide what the boxes and slabs leave open. The accessors are for the kernels in wide_bvh.cpp.
class WideBvh {
 public:
  /// Boxes in a group.
  static constexpr std::uint32_t width = 16;

  /// The boxes of a group; unused ones are empty.
  struct Boxes {
    alignas(64) float lo[3][width], hi[3][width];
  };
  /// For each triangle of a group: a direction close to its normal, and the interval [from, to]
  /// that the triangle covers along it. A segment with both ends beyond the same end of the
  /// interval does not touch the triangle. The interval is widened by the rounding error of such
  /// products for box coordinates of at most 2 in magnitude; blocked() does not use slabs for
  /// others.
  struct Slabs {
    alignas(64) float normal[3][width], from[width], to[width];
  };

  /// A tree over no triangles.
  WideBvh() = default;
  /// `order`: a permutation of the indices of `corners` that keeps neighbours together. Sixteen
  /// consecutive triangles form a group, sixteen consecutive groups the next one, and so on.
  WideBvh(std::span<const std::array<Vec3, 3>> corners, std::span<const std::uint32_t> order);

  /// For each closed segment from p to a point of `ends`, writes 1 to `result` if it touches a
  /// triangle, else 0. Exact. `corners` and `order`: those of the construction.
  void blocked(std::span<const std::array<Vec3, 3>> corners, std::span<const std::uint32_t> order, const Vec3& p,
               std::span<const Vec3> ends, std::uint8_t* result) const;
  /// The same, but leaves `result` as it is for segments that touch no triangle.
  void add_blocked(std::span<const std::array<Vec3, 3>> corners, std::span<const std::uint32_t> order, const Vec3& p,
                   std::span<const Vec3> ends, std::uint8_t* result) const;
  /// Removes the triangle at a place of the order: it blocks no segment any more.
  void remove(std::uint32_t place);

  /// The origin of box coordinates, in model coordinates.
  const Vec3& middle() const { return middle_; }
  /// The scale of box coordinates: 1 / largest distance of a coordinate from the origin, or 1 where
  /// that is too small for a reciprocal.
  double scale() const { return scale_; }
  /// A model coordinate in box coordinates.
  float local(double x, int axis) const { return static_cast<float>((x - middle_[axis]) * scale_); }
  /// levels()[0] holds boxes of triangles, levels()[l] those of groups of levels()[l − 1]. There
  /// are two levels or more, or none without triangles.
  const std::vector<std::vector<Boxes>>& levels() const { return levels_; }
  /// The slabs of the triangles, by group of levels()[0].
  const std::vector<Slabs>& slabs() const { return slabs_; }

 private:
  Vec3 middle_ = Vec3::Zero();
  double scale_ = 1;
  std::vector<std::vector<Boxes>> levels_;
  std::vector<Slabs> slabs_;
};

}  // namespace geo
