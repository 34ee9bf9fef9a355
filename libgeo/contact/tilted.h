// Directions that part sheets which slide over each other: along their normals, tilted as far as it takes where they are not flat.
#pragma once

#include "contact/parting_lanes.h"

namespace geo {

/// True when `accept(n, first, last)` is for a unit direction between the normals of a couple and the way between its closest
/// places, as find_partings() has them: how far n parts it at `from` and at `to`.
template <class Accept>
bool some_tilted(const Couple& couple, const Partings& p, std::size_t lane, const std::vector<Vec3>& from, const std::vector<Vec3>& to, const Accept& accept) {
  constexpr double tilts[] = {0, 0.01, 0.03, 0.09, 0.27};
  const auto direction = [&](int k) { return Vec3(p.normal[k][0][lane], p.normal[k][1][lane], p.normal[k][2][lane]); };
  const Vec3 a = direction(Partings::a_normal), b = direction(Partings::b_normal), closest = direction(Partings::closest);
  for (const double tilt : tilts)
    for (const Vec3& normal : {a, b, Vec3(a + b)}) {
      const Vec3 n = (normal + tilt * closest).normalized();
      if (accept(n, parted(n, couple.a, couple.b, from), parted(n, couple.a, couple.b, to))) return true;
    }
  return false;
}

}  // namespace geo
