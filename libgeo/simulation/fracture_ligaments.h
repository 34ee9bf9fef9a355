// Ligaments: thin material that the fronts of a crack leave where they come out of a body.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "simulation/fracture_front.h"

namespace geo {

/// The borders of a growing crack that end in material within `where` and belong to none of
/// `fronts`, each as a front whose points are vertices of the complex. They arise where parts of a
/// front come out on different sides of an edge of the body.
std::vector<FrontState> unfollowed_borders(const Complex& complex, std::int32_t crack, const Box3& where,
                                           std::span<const GrowingFront> fronts);

/// Next positions of such a front that cut the ligament ahead of it in one step. Empty where the
/// ligament is thicker than `thickness`, model units, or the ends of the front would pass through
/// material.
std::vector<Vec3> across_ligament(const Complex& complex, const FrontState& front, double thickness);

/// True where less than half of `spacing`, the node spacing there, of material is ahead of a front
/// point.
bool is_ligament(const Complex& complex, const TipFrame& tip, double spacing);

}  // namespace geo
