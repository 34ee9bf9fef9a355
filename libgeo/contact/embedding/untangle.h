// Untangling: separates triangles that cross, in the order in which they lie in the material.
#pragma once

#include <functional>

#include "contact/detection/find_crossings.h"
#include "contact/surface/contact_surface.h"

namespace geo {

/// A surface to untangle. Refers to data of the caller. At `rest`, no triangles cross.
struct UntangleInput {
  const ContactSurface& surface;
  std::function<Vec3(std::uint32_t)> rest;      ///< position of a surface vertex in the material
  std::function<Mat3(std::uint32_t)> gradient;  ///< deformation gradient at a surface vertex
  const std::vector<std::uint8_t>& fresh;       ///< per triangle: embedded by Eq. 1, so its given position may cross
  double gap;                                   ///< largest wanted separation, model units
  double reach;  ///< farthest that a vertex moves with the material around it, model units
};

/// Moves vertices until no triangle marked in `marked` crosses another, or until several rounds
/// bring no progress. Crossing triangles are pushed apart by equal shares. The direction is one
/// that separates them in the material: that of their distance, transformed by the deformation
/// gradient. Where that leaves crossings, a second attempt takes the normal of features where it
/// moves them less. Two triangles that are not fresh did not cross at the given positions, so
/// directions that separate them there are used: closed sheets are one place in the material.
/// Coincident vertices stay coincident. Returns the pairs that still cross, and marks all triangles
/// whose vertices have moved.
std::vector<TrianglePair> untangle(const UntangleInput& input, std::vector<Vec3>& positions,
                                   std::vector<std::uint8_t>& marked);

}  // namespace geo
