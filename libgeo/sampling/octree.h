// Octree leaves over a solid, graded 2:1 from fine at the surface to coarse in the depth (Pauly et al. 2005).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/vec.h"

namespace geo {

/// A leaf of edge length size·2^level, with its lower corner at origin + size·corner.
struct Cell {
  std::array<std::int32_t, 3> corner;  ///< in finest cells, a multiple of 2^level
  int level = 0;
};

/// Leaves that cover `box`, none coarser than `levels` − 1; `depth(p)` is positive inside. A cell is divided while its
/// middle is less deep than the cell is large; cells wholly outside are left out. Neighbours (corners included) differ
/// by one level at most. In Morton order.
std::vector<Cell> build_octree(const Box3& box, double size, int levels, const std::function<double(const Vec3&)>& depth);

}  // namespace geo
