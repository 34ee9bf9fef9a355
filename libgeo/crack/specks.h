// Pieces too thin to be anything but the rounding of a sheet.
#pragma once

#include <vector>

#include "kerf/complex.h"

namespace geo::crack {

/// The specks that a step has cut off. A speck is a closed part of the derived surface with at most
/// `max_sides` sides, whose volume over half of its area is less than `thickness` (model units).
/// Returns one new face of a crack for each, which lies between the speck and the rest. Without
/// that face, the speck is a part of what is behind it. `delta`: of the step. Cost follows the new
/// faces, and `max_sides` once: a long sliver beside the wall of an older cut has some hundreds.
std::vector<FaceId> find_specks(const Complex& complex, const CrackDelta& delta, double thickness,
                                std::size_t max_sides = 512);

}  // namespace geo::crack
