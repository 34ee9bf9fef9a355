// The guard before a commit: what rounding must not have done.
#pragma once

#include <string>

#include "surface/complex.h"

namespace geo {

/// Checks an edit against K as it is: every new face has the orientation of what it is a part of (`planes[i]`: three
/// points in whose plane new_faces[i] lay before rounding) and an area, no new vertex stands where another does, and no
/// new face crosses a near one. Exact. Returns what is wrong, empty when nothing is. Cost follows the edit.
std::string find_fault(const Complex& complex, const ComplexEdit& edit, const std::vector<std::array<Vec3, 3>>& planes);

}  // namespace geo
