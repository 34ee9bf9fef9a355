// Points, segments and triangles as simplices: closest points, separation along a direction, and
// the sub-simplices of two triangles that must stay disjoint.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "kerf/vec.h"

namespace geo {

/// The indices of one, two or three vertices.
struct Simplex {
  std::uint32_t v[3];
  int size;
};

/// Closest points of two simplices a and b.
struct ClosestPoints {
  Vec3 weights_a = Vec3::Zero();   ///< barycentric coordinates of the point of a
  Vec3 weights_b = Vec3::Zero();   ///< barycentric coordinates of the point of b
  Vec3 difference = Vec3::Zero();  ///< point of a − point of b
};

/// The closest points of two disjoint simplices, given by 1 to 3 corners each. Triangles must
/// have an area. Floating point.
ClosestPoints closest_points(const Vec3* a, int a_size, const Vec3* b, int b_size);

/// The separation of a from b along direction n: min n · x over a minus max n · x over b. If it is
/// positive, a plane with normal n separates them. `at`: positions by vertex.
template <class Points>
double separation_along(const Vec3& n, const Simplex& a, const Simplex& b, const Points& at) {
  double least = n.dot(at[a.v[0]]), most = n.dot(at[b.v[0]]);
  for (int k = 1; k < a.size; ++k) least = std::min(least, n.dot(at[a.v[k]]));
  for (int k = 1; k < b.size; ++k) most = std::max(most, n.dot(at[b.v[k]]));
  return least - most;
}

/// Two triangles without a common vertex must be disjoint as a whole. If they share vertices, the
/// remaining sub-simplex of each must be disjoint from the other triangle. Writes these pairs of
/// sub-simplices to `pairs` and returns their number: 1, 2, or 0 if one has all vertices
/// of the other.
int disjoint_subsimplices(const Triangle& s, const Triangle& t, std::pair<Simplex, Simplex> (&pairs)[2]);

}  // namespace geo
