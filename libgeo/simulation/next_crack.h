// Numbers of cracks that a run begins.
#pragma once

#include <cstdint>

#include "kerf/complex.h"
#include "kerf/simulation.h"

namespace geo {

/// The lowest crack number above those of the complex and of all fronts of a run. A front has its
/// number before it has cut anything.
std::int32_t next_crack(const Complex& surface, const RunState& state);

}  // namespace geo
