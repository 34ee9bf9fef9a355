// Parts triangles that cross, by what the material says about who is on which side.
#pragma once

#include <functional>

#include "contact/surface/contact_surface.h"

namespace geo {

/// Moves vertices until no triangle marked in `marked` crosses another, or for so many sweeps in vain. In the material,
/// where a vertex is at `rest`, no two cross: the direction that parts two there, turned and bent as the material is
/// (`slope`: the deformation's derivative at a vertex), is along which they are pushed apart, equally. Two that are not
/// `fresh` do not cross as they are given: there it is the direction that parts them then, since sheets that lie on
/// each other are one place in the material. Vertices together move together. Returns the pairs that still cross;
/// triangles whose vertices moved are marked besides.
std::vector<std::pair<std::uint32_t, std::uint32_t>> untangle(const ContactSurface& surface,
                                                              const std::function<Vec3(std::uint32_t)>& rest,
                                                              const std::function<Mat3(std::uint32_t)>& slope,
                                                              const std::vector<std::uint8_t>& fresh, double gap,
                                                              std::vector<Vec3>& positions,
                                                              std::vector<std::uint8_t>& marked);

}  // namespace geo
