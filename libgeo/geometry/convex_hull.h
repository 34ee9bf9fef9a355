// Convex hulls of points, complete or limited to a number of corners.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Triangles of the convex hull of `points`, as indices of points, counter-clockwise from outside.
/// Exact. With max_corners ≥ 4, stops at this number of corners: corners are added in quickhull's
/// order, each the farthest from the hull so far (Barber, Dobkin, Huhdanpaa 1996). Points then
/// stick out by at most 1.9 % of the diagonal of their box with 64 corners and 3.6 % with 32; the
/// worst are balls. Empty if all points are coplanar.
std::vector<Triangle> convex_hull(std::span<const Vec3> points, std::size_t max_corners = ~std::size_t(0));

/// A convex polyhedron: its corners, each used, and triangles counter-clockwise from outside.
struct ConvexPolyhedron {
  std::vector<Vec3> corners;
  std::vector<Triangle> triangles;
};

/// A convex polyhedron of at most max_corners ≥ 4 corners near the hull of `points`. A hull within
/// this number is exact. Else the corners of convex_hull() move outwards: each face is to move by
/// half of what its points stick out, and a corner moves as its faces want in the least squares.
/// Points then stick out of the polyhedron about as far as it sticks out of their hull (decision
/// 097). Empty if all points are coplanar.
ConvexPolyhedron fitted_hull(std::span<const Vec3> points, std::size_t max_corners);

}  // namespace geo
