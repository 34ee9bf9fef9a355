// Thickness of the material: the other side of a wall along the normal.
#pragma once

#include "sampling/region.h"

namespace geo {

/// A wall of material.
struct Wall {
  double thickness = std::numeric_limits<double>::infinity();  ///< infinite: no wall below the limit
  Vec3 at = Vec3::Zero();                                      ///< a point in its middle
  double area = 0;                                             ///< of both its sides, as far as searched
};

/// The thinnest wall, thinner than `limit`, to which a triangle of a cut cell belongs. A ray goes
/// inwards from the middle of each triangle's part in the cell. The normals of the two sides of a
/// wall are opposite within 26° (cosine −0.9). An edge sharper than 26° counts as a wall that
/// tapers off, a blunter one as an edge.
Wall thinnest_wall(const RegionTree& tree, const Lattice& lattice, const Region& cut, double limit);

/// The wall of which a triangle is one side, at the middle of the triangle. Its area is that of the
/// triangle.
Wall wall_behind(const RegionTree& tree, std::uint32_t triangle, double limit);

/// The same for a wall that point p is inside, of which `closest` (within limit / 2) is one side.
Wall wall_around(const RegionTree& tree, const Vec3& p, const TriangleBvh::Closest& closest, double limit);

}  // namespace geo
