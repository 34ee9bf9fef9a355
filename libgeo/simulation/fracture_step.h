// One time step of fracture: cracks begin, go on, divide, and come to rest.
#pragma once

#include <functional>

#include "kerf/run.h"
#include "kerf/scene.h"
#include "kerf/solid.h"
#include "simulation/fracture_front.h"

namespace geo {

/// Makes one step of a crack in the body, and lets the mechanics follow; false when it cannot be
/// made.
using SplitStep = std::function<bool(FrontState&, const std::vector<Vec3>& next)>;

/// Each live front point works out the stress about it (tip_field) and the direction in which it is
/// largest. Both are smoothed along the front, as a separation tensor. Where the stress passes what
/// the toughness asks for, σ_c, the point goes on at c_max (1 − (σ_c / σ)²), c_max = fracture.speed
/// · rayleigh_speed(), and by a spacing of the nodes at most: the stress must be told anew before
/// it goes farther. Points rest while the stress is less and start again when it rises. A front is
/// moved once it owes a quarter of a spacing. What is ahead of a point that too few nodes see to
/// tell its stress, thinner than half a spacing, parts, and so does a ligament that fronts have
/// left behind at an edge of the body, thinner than a spacing (across_ligament). Then cracks begin
/// where find_starts() says. `body_index`: per node, its body of the scene. It, `body` and `motion`
/// change through `split` only. The same for any number of threads.
void step_fracture(const FractureOptions& fracture, const std::vector<std::uint32_t>& body_index, const Body& body,
                   const Solid& solid, const State& motion, double dt, FractureState& state, const SplitStep& split,
                   FractureStats* work = nullptr);

}  // namespace geo
