// Many short segments against triangles, sixteen boxes at a time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// A tree of boxes, sixteen to a block, over triangles in an order that keeps neighbours together. All is in floats, in
/// a frame in which the triangles' coordinates are at most 1 in magnitude. Going to that frame is monotone, rounding
/// and all, so boxes that meet still meet there; nothing is lost, and what may touch is left to exact predicates.
class WideBvh {
 public:
  static constexpr std::uint32_t width = 16;

  struct Boxes {
    alignas(64) float lo[3][width], hi[3][width];
  };
  /// For each triangle the stretch [from, to] that it covers along a direction close to its normal, widened by what the
  /// same product may be off for points within twice the frame: a segment beyond it does not touch.
  struct Slabs {
    alignas(64) float normal[3][width], from[width], to[width];
  };

  WideBvh() = default;
  /// `order`: all rows of `corners`. Sixteen consecutive ones make a block, sixteen consecutive blocks the next, and so
  /// on.
  WideBvh(std::span<const std::array<Vec3, 3>> corners, std::span<const std::uint32_t> order);

  /// For each closed segment from p to a point of `ends`: 1 where it touches a triangle, else 0. Exact. `corners` and
  /// `order` are those that the tree was made of.
  void blocked(std::span<const std::array<Vec3, 3>> corners, std::span<const std::uint32_t> order, const Vec3& p,
               std::span<const Vec3> ends, std::uint8_t* result) const;

  /// The frame: a coordinate's place in it is its difference from middle(), times scale(), as a float.
  const Vec3& middle() const { return middle_; }
  double scale() const { return scale_; }
  float local(double x, int axis) const { return static_cast<float>((x - middle_[axis]) * scale_); }
  /// levels()[0] holds boxes of triangles, levels()[l] those of blocks of levels()[l − 1]; two levels at least.
  const std::vector<std::vector<Boxes>>& levels() const { return levels_; }
  const std::vector<Slabs>& slabs() const { return slabs_; }

 private:
  Vec3 middle_ = Vec3::Zero();
  double scale_ = 1;
  std::vector<std::vector<Boxes>> levels_;
  std::vector<Slabs> slabs_;
};

}  // namespace geo
