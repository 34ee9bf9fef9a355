// The planes of triangles, as a quick look at which two they part.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "base/uninitialized_array.h"
#include "kerf/vec.h"

namespace geo {

/// Of all triangles of a surface, where a motion begins and where it ends: what is asked about many pairs at once,
/// corners side by side in vectors. The normals are those of the beginning. Floating point, to some 1e-15 of
/// coordinates, the same for any processor.
class TrianglePlanes {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  TrianglePlanes() = default;
  TrianglePlanes(std::span<const Triangle> triangles, const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
    place(triangles, from, to);
  }

  /// Of another motion, in the same memory where there is enough. Refers to triangles and ends.
  void place(std::span<const Triangle> triangles, const std::vector<Vec3>& from, const std::vector<Vec3>& to);

  /// After the end of triangle i has changed.
  void renew_end(std::size_t i);

  /// Whether the plane of one of triangles i and j parts them, with the same side, by more than `first` where the
  /// motion begins and by more than `last` where it ends. Neither is negative.
  bool part(std::uint32_t i, std::uint32_t j, double first, double last) const;

  /// Of pairs those that no plane parts so, in their order.
  void keep_unparted(std::vector<Pair>& pairs, double first, double last) const;

  /// Of pairs those that the way from the middle of the second to that of the first, where the motion begins, does not
  /// part by more than `first` there and by more than `last` where it ends: of triangles that lie beside each other in
  /// a surface it does, where their planes do not.
  void keep_unparted_across(std::vector<Pair>& pairs, double first, double last) const;

  /// The farther of the two planes' distances between the triangles of each pair where the motion ends, on the side
  /// where it begins; negative when they pass through each other.
  std::vector<double> left(std::span<const Pair> pairs) const;

  /// Four corners an axis, the last of them twice.
  struct Plane {
    alignas(32) double at[2][3][4];  // corners, where the motion begins and where it ends
    double normal[3];                // unit; of a triangle without area zero
    double middle[3];                // where the motion begins
    double low[2],
        high[2];  // of the corners along the normal, at the beginning (of slivers not the same) and at the end
  };

 private:
  std::span<const Triangle> triangles_;
  const std::vector<Vec3>* to_ = nullptr;
  UninitializedArray<Plane> planes_;
};

}  // namespace geo
