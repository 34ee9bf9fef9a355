// What fronts leave behind where they come out of a body.
#pragma once

#include "simulation/fracture_front.h"

namespace geo {

/// The parts of the border of a growing crack that end in material within `where` and that none of `fronts` follows,
/// each as a front of its own, whose points are all in the complex. Where parts of a front come out on different sides
/// of an edge of the body, they may leave a ligament there.
std::vector<FrontState> left_behind(const Complex& complex, std::int32_t crack, const Box3& where,
                                    std::span<const GrowingFront> fronts);

/// Where the points of such a front go that parts the ligament ahead of it at once; empty where this is thicker than
/// `most`, or the ends of the front would not go through air.
std::vector<Vec3> across_ligament(const Complex& complex, const FrontState& front, double most);

/// True where less than half of `spacing` is ahead of a front point.
bool is_ligament(const Complex& complex, const TipFrame& tip, double spacing);

}  // namespace geo
