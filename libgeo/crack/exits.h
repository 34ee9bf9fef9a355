// The guard's test that a front's line, where it leaves the material, stays outside after rounding.
#pragma once

#include <array>
#include <span>

#include "crack/guard.h"

namespace geo {

/// The fault of the first exit that is not outside after the edit; none if all are. The next step
/// would start from it, re-enter the material and leave a passage finer than doubles there.
///
/// Conditions: the exit starts outside the skin around its first vertex, and around its last one
/// where it comes back. It touches no other face of the skin. Exact, except that a
/// rounded point of a face counts as lying on it. Cost follows the faces around the exits, and
/// the edit.
Fault find_reentry(const Complex& complex, const ComplexEdit& edit, std::span<const FrontExit> exits);

/// Whether the line from u to q starts inside the solid angle that the faces around u bound.
/// `fan`: their corners (u, a, b) each, oriented outwards. False for a line along a face.
bool begins_inside(const Vec3& u, const Vec3& q, std::span<const std::array<Vec3, 3>> fan);

}  // namespace geo
