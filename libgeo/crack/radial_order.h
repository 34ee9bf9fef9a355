// The part of the guard that asks how faces stand around edges.
#pragma once

#include "crack/guard.h"

namespace geo {

/// The first edge of an edit around which rounded faces stand otherwise than they are listed:
/// sheets have changed places there, and nothing is between them where the rings say that there is
/// material. Arguments as of find_fault(). Exact; the cost follows the edit.
Fault find_misplaced(const Complex& complex, const ComplexEdit& edit, std::span<const std::uint8_t> moved);

}  // namespace geo
