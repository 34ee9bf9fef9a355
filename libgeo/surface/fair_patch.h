// Fills a hole by a fair patch that continues the surface around it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// A patch. Its corners are numbered: those of the rim first, then its inner vertices.
struct FairPatch {
  std::vector<Vec3> inner;  ///< positions of the inner vertices
  /// Per inner vertex: the corners, of lower numbers, of the triangle that it divided.
  std::vector<std::array<std::uint32_t, 3>> between;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< of corners; oriented along the rim
};

/// A patch with triangles as fine as the rim, of least bending, that leaves the rim in the tangent
/// plane of the surface (P. Liepa, Filling holes in meshes, 2003, from its second step on; weights
/// are inverse lengths). `rim`: at least three corners; `beyond`: per corner, the neighbours other
/// than along the rim; `joined`: whether two corners have an edge already. The patch may cross
/// itself or other triangles: the caller checks. Empty where it would have more than a million
/// triangles.
FairPatch fair_patch(const std::vector<Vec3>& rim, const std::vector<std::vector<Vec3>>& beyond,
                     const std::function<bool(std::uint32_t, std::uint32_t)>& joined);

}  // namespace geo
