// A way from one point in the material to another along the surface between them.
#pragma once

#include <vector>

#include "kerf/body.h"

namespace geo {

/// A chain of points from `from` to `to`, both included, of which no link touches a face of K: along the sides that
/// both see, as close to them as it takes, so that what the material joins is joined however narrow it is. `reach`
/// (world units): how far both look for sides, and how high above them the way begins to be looked for. Empty when both
/// see different shells only, or when doubles are too coarse for what lies between.
std::vector<Vec3> way_along(const Complex& k, const Vec3& from, const Vec3& to, double reach);

}  // namespace geo
