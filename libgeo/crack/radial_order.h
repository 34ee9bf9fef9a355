// The guard's test that rounding has kept the radial order of faces around edges.
#pragma once

#include "crack/guard.h"

namespace geo {

/// The first edge around which faces with rounded points are no longer in the radial order listed:
/// sheets have exchanged places there. `moved` as in GuardContext. Exact. Cost follows the edit.
Fault find_radial_fault(const Complex& complex, const ComplexEdit& edit, std::span<const std::uint8_t> moved);

}  // namespace geo
