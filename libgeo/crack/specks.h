// Pieces too thin to be anything but the rounding of a sheet.
#pragma once

#include "kerf/complex.h"

namespace geo::crack {

/// Whether a step has cut off a speck: a closed part of the derived surface with at most
/// `most_sides` sides, whose volume over half of its area is less than `thickness` (model units).
/// `delta`: of the step. Cost follows the new crack faces.
bool leaves_speck(const Complex& complex, const CrackDelta& delta, double thickness, std::size_t most_sides = 64);

}  // namespace geo::crack
