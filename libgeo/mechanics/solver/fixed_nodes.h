// Nodes that the environment clamps or lets sleep.
#pragma once

#include "kerf/solid.h"

namespace geo {

/// Whether node i is clamped.
inline bool is_fixed(const Environment& e, std::size_t i) { return !e.fixed.empty() && e.fixed[i]; }

/// Whether node i sleeps.
inline bool is_asleep(const Environment& e, std::size_t i) { return !e.asleep.empty() && e.asleep[i]; }

}  // namespace geo
