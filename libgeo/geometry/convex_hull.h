// Convex hulls, whole or of few corners.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Triangles of the convex hull of some points, by rows of the points, counter-clockwise from outside. Decided exactly.
/// With `most` ≥ 4 corners the hull of a part of the points is returned, chosen one by one, each the farthest from what
/// there is (quickhull's order: Barber, Dobkin, Huhdanpaa 1996). Empty when all points lie in one plane.
std::vector<Triangle> convex_hull(std::span<const Vec3> points, std::size_t most = ~std::size_t(0));

}  // namespace geo
