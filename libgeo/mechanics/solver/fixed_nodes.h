// Nodes that the environment clamps.
#pragma once

#include "kerf/solid.h"

namespace geo {

/// Whether node i is clamped.
inline bool is_fixed(const Environment& e, std::size_t i) { return !e.fixed.empty() && e.fixed[i]; }

}  // namespace geo
