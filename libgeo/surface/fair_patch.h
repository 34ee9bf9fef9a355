// A patch over a hole that goes on from the surface around it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Corners of a patch are numbered: first those of the rim, then its own vertices.
struct FairPatch {
  std::vector<Vec3> inner;  ///< its own vertices
  std::vector<std::array<std::uint32_t, 3>>
      between;  ///< of each, three corners with lesser numbers in whose middle it was put
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< of corners; they run the rim's way
};

/// Triangles as fine as the rim, on a surface that bends as little as it can and leaves the rim as
/// the surface beyond it comes there (P. Liepa, Filling holes in meshes, 2003, from the second step
/// on; weights are inverse lengths). `rim`: at least three corners; `beyond`: of each, the points
/// that it has edges to other than along the rim; `joined`: whether two corners have an edge
/// already. The patch may cross itself or something else: who takes it looks. Without triangles
/// where it would have more than a million of them.
FairPatch fair_patch(const std::vector<Vec3>& rim, const std::vector<std::vector<Vec3>>& beyond,
                     const std::function<bool(std::uint32_t, std::uint32_t)>& joined);

}  // namespace geo
