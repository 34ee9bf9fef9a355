// The ground that nodes stand on: a penalty on depth, and drag along it.
#pragma once

#include "kerf/solid.h"

namespace geo {

inline bool is_fixed(const Environment& e, std::size_t i) { return !e.fixed.empty() && e.fixed[i]; }

/// How deep a node's skin is in the ground; ≤ 0: not touching.
inline double depth(const Environment& e, std::size_t i, const Vec3& x) {
  return (e.clearance.empty() ? 0.0 : e.clearance[i]) - e.ground_normal.dot(x - e.ground_point);
}

}  // namespace geo
