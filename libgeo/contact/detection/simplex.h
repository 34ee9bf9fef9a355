// Points, segments and triangles that must stay apart: the closest places of two, and how far a direction parts them.
#pragma once

#include <cstdint>

#include "kerf/vec.h"

namespace geo {

/// Rows of one, two or three points.
struct Simplex {
  std::uint32_t v[3];
  int size;
};

struct ClosestPlaces {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< weights of the corners of the first and the second
  Vec3 apart = Vec3::Zero();                    ///< from the second's place to the first's
};

/// The closest places of two simplices that do not meet, given by their corners. Floating point.
ClosestPlaces closest_places(const Vec3* a, int a_size, const Vec3* b, int b_size);

/// How far direction n parts a from b: the least of n over a less the most over b. Negative when it does not.
template <class Points>
double parted(const Vec3& n, const Simplex& a, const Simplex& b, const Points& at) {
  double least = n.dot(at[a.v[0]]), most = n.dot(at[b.v[0]]);
  for (int k = 1; k < a.size; ++k) least = std::min(least, n.dot(at[a.v[k]]));
  for (int k = 1; k < b.size; ++k) most = std::max(most, n.dot(at[b.v[k]]));
  return least - most;
}

}  // namespace geo
