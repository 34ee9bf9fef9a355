// A taut path along the surface, from one point in the material to another.
#pragma once

#include <vector>

#include "kerf/body.h"

namespace geo {

/// Finds a polyline from `from` to `to`, both included, of which no segment touches a face of K. It
/// follows the sides of a shell that both points see, as close to them as necessary; so it finds a
/// path through passages of any width. `reach` (model units) bounds the search for visible sides
/// and the initial height of the path above them. Empty when the points see different shells only,
/// or when double precision is too coarse for the passage.
std::vector<Vec3> taut_path(const Complex& k, const Vec3& from, const Vec3& to, double reach);

}  // namespace geo
