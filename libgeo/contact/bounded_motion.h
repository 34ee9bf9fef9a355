// Moves a surface to where it should be, or as near to it as it comes without crossing itself.
#pragma once

#include "contact/watch.h"

namespace geo {

struct BoundedMotion {
  std::size_t planes = 0;    ///< between parts that might have met
  std::size_t rounds = 0;    ///< of planes
  std::size_t in_zones = 0;  ///< vertices that had to move as rigid zones
  bool held = false;         ///< nothing could be carried along
};

/// The end of the motion, by row; rows together move together. At the beginning no triangles cross, and at the end none do. First all are carried along: by the affine motion closest to what they want, then by a smooth field of what
/// they want beyond (smooth_field.h), in which neither side of a narrow gap passes the other; what crosses all the same, by the
/// exact test of crossing.h, since triangles are flat and the field is not, moves as rigid zones (Provot 1997; Bridson, Fedkiw,
/// Anderson 2002), which grow until nothing does. Then each vertex for itself goes straight on where nothing is in its way
/// (straight_motion.h), and as far as planes between near parts let it (dividers.h), in a few rounds.
std::vector<Vec3> move_without_crossing(const SurfaceMotion& motion, bool two_sided, BoundedMotion* report = nullptr);

}  // namespace geo
