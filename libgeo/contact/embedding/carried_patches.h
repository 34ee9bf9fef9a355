// Patches of a surface that cross in a deformed position although they do not in the material, each
// carried by one affine map of the material.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "contact/embedding/untangle.h"

namespace geo {

/// A surface that crosses itself at the positions given. Refers to data of the caller.
struct CrossedSurface {
  const UntangleInput& in;
  const std::vector<std::uint32_t>& representative;  ///< per surface vertex, coincident_representatives()
  const std::vector<Vec3>& given;                    ///< positions, world
  const std::vector<TrianglePair>& crossings;        ///< at these
};

/// Positions of a surface whose patches are carried.
struct CarriedPatches {
  std::vector<Vec3> positions;       ///< per surface vertex, world
  std::vector<std::uint8_t> marked;  ///< per triangle: as given, and those of which a vertex has moved
};

/// Carries patches until no triangle marked in `marked` crosses another. Empty where that takes too
/// many rounds, or a vertex would move farther than `in.reach`: what crosses there has come from
/// places far apart, and no map of the material is near to it.
///
/// A patch: the corners of triangles that cross, joined where one triangle is in several pairs. An
/// affine map of positive volume keeps apart what is apart at rest, however thin; the map of the
/// body bends triangles, and slivers thinner than it bends by are turned over. The map is the best
/// to the positions given, by least squares; along directions in which the patch is flat, it takes
/// the mean deformation gradient. A patch that crosses others then takes them in.
///
/// `marked`: per triangle. The cost is that of find_crossings() with the triangles of the patches.
std::optional<CarriedPatches> carry_patches(const CrossedSurface& surface, const std::vector<std::uint8_t>& marked);

}  // namespace geo
