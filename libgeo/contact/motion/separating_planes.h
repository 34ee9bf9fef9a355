// Separating planes between near triangles: while each vertex stays on its side of them, nothing
// can cross, whatever path each vertex takes.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Triangles that may be near each other, and where their vertices want to be.
struct PlaneSeparatedMotion {
  const std::vector<Triangle>& triangles;                          ///< of representatives
  std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs;  ///< of triangles; no others come together
  const std::vector<Vec3>& to;                                     ///< per vertex: wanted position
  const std::vector<double>& limit;                                ///< per vertex: longest move, model units
  double gap = 0;                                                  ///< distance that surfaces in contact keep
};

/// Moves the vertices `at`, of which no two triangles cross, towards their wanted positions: each
/// as far as the separating planes of its pairs allow, sliding along them. A plane is normal to an
/// axis of CandidateAxes, at the middle of the wanted positions of both sides, clamped to the free
/// interval. At the end nothing crosses: the planes of a vertex do not depend on others' moves.
/// Floating point, with half the gap to spare; sub-simplices whose distance is of the order of
/// rounding stay where they are. Returns the number of planes.
std::size_t move_between_planes(const PlaneSeparatedMotion& motion, std::vector<Vec3>& at);

}  // namespace geo
