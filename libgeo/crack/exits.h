// The guard's test that a front's line, where it leaves the material, stays outside after rounding.
#pragma once

#include <array>
#include <span>

#include "crack/guard.h"

namespace geo {

/// The first exit that is not outside after the edit. The next step would start from it, re-enter
/// the material and leave a passage there that is finer than doubles. An exit must start outside
/// the skin around its first vertex, likewise at its last vertex where it comes back, and touch no
/// other face of the skin. Exact, but that the midpoint of a face is taken to lie on the face. Cost
/// follows the faces around the exits, and the edit.
Fault find_reentry(const Complex& complex, const ComplexEdit& edit, std::span<const FrontExit> exits);

/// Whether the line from u to q starts inside the solid angle that the faces around u bound.
/// `fan`: their corners (u, a, b) each, oriented outwards. False for a line along a face.
bool begins_inside(const Vec3& u, const Vec3& q, std::span<const std::array<Vec3, 3>> fan);

}  // namespace geo
