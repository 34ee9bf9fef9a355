// Moves a surface to where it should be, or as near to it as it comes without crossing itself.
#pragma once

#include "contact/watch.h"

namespace geo {

struct BoundedMotion {
  std::size_t watched = 0;    ///< pairs that might have met
  std::size_t sweeps = 0;     ///< through them, to push them apart
  std::size_t in_zones = 0;   ///< vertices that had to move as rigid zones
  bool held = false;          ///< nothing could be moved: all are where they were
};

/// The end of the motion, by row; rows together move together. At the beginning no triangles cross, and at the end none do, by
/// the exact test of crossing.h. First the planes of watched pairs push apart what would meet; what they do not part moves as
/// rigid zones (Provot 1997; Bridson, Fedkiw, Anderson 2002), which grow until nothing crosses; at worst all is one zone, and if
/// rounding prevents even that, nothing moves.
std::vector<Vec3> move_without_crossing(const SurfaceMotion& motion, bool two_sided, BoundedMotion* report = nullptr);

}  // namespace geo
