// Directions that part sheets which slide over each other: along their normals, tilted as far as it takes where they
// are not flat.
#pragma once

#include "contact/detection/parting_lanes.h"

namespace geo {

/// True when `accept(n, first, last)` is for a unit direction between the normals of a couple and the way between its
/// closest places, as find_partings() has them: how far n parts it at `from` and at `to`.
template <class Accept>
bool some_tilted(const Couple& couple, const Partings& p, std::size_t lane, const std::vector<Vec3>& from,
                 const std::vector<Vec3>& to, const Accept& accept) {
  TiltedPartings tilted;
  find_tilted(couple, p, lane, from, to, tilted);
  for (int k = 0; k < TiltedPartings::count; ++k)
    if (accept(Vec3(tilted.normal[0][k], tilted.normal[1][k], tilted.normal[2][k]), tilted.first[k], tilted.last[k]))
      return true;
  return false;
}

}  // namespace geo
