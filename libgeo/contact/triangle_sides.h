// On which side of each other's planes triangles lie, as a quick look at which cannot cross.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "base/vec.h"

namespace geo {

/// Of all triangles of a surface at one time: what is asked about many pairs at once, corners side by side in vectors.
class TriangleSides {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  /// Triangle t has the corners together[v] for each v of triangles[t], at positions[together[v]].
  TriangleSides(std::span<const Triangle> triangles, std::span<const std::uint32_t> together, const std::vector<Vec3>& positions);

  /// Of pairs those of which neither triangle has all its corners, but those that it shares with the other, strictly on one side of
  /// the other's plane; in their order. The others have no more in common than corners and edges. Signs as sure as those of
  /// orient3d_quick(): what they cannot tell is kept. Two triangles with the same three corners are kept.
  void keep_unclear(std::vector<Pair>& pairs) const;

  /// Four corners an axis, the last of them twice.
  struct Corners {
    alignas(32) double at[3][4], row[4];
    double normal[3], terms[3];  // of the plane: differences of two products, and the sums of their absolute values
  };

 private:
  std::vector<Corners> triangles_;
};

}  // namespace geo
