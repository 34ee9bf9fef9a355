// Where a front's line leaves the material: what rounding must not have made of it.
#pragma once

#include <array>
#include <span>

#include "crack/guard.h"

namespace geo {

/// The first exit that is not outside after the edit: the next step would start from it and leave a
/// passage there that is finer than doubles. It must begin, and end where it comes back, outside of
/// what the skin bounds about that vertex, and meet no other face of the skin. Exact, but for a
/// face's middle that is taken to be on it. Cost follows the faces about the exits and the edit.
Fault find_return(const Complex& complex, const ComplexEdit& edit, std::span<const Exit> exits);

/// Whether the line from u to q begins inside of what the faces about u bound: (u, a, b) each,
/// outwards. False along a face.
bool begins_inside(const Vec3& u, const Vec3& q, std::span<const std::array<Vec3, 3>> fan);

}  // namespace geo
