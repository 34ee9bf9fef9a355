// Contact of nodes with the ground plane: a penalty on depth, and friction linearised about the
// start of the step.
#pragma once

#include "kerf/solid.h"

namespace geo {

/// Whether node i is clamped.
inline bool is_fixed(const Environment& e, std::size_t i) { return !e.fixed.empty() && e.fixed[i]; }

/// Depth of the skin below node i in the ground, with the node at x; not positive: no contact.
inline double ground_depth(const Environment& e, std::size_t i, const Vec3& x) {
  return (e.clearance.empty() ? 0.0 : e.clearance[i]) - e.ground_normal.dot(x - e.ground_point);
}

/// The component of d along the ground plane.
inline Vec3 ground_tangential(const Environment& e, const Vec3& d) {
  return d - e.ground_normal.dot(d) * e.ground_normal;
}

}  // namespace geo
