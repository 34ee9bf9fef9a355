// One time step of fracture: cracks begin, go on, divide, and come to rest.
#pragma once

#include <functional>

#include "kerf/scene.h"
#include "kerf/solid.h"
#include "simulation/fracture_front.h"

namespace geo {

/// What the next time step of fracture needs to know of those before, besides the body.
struct FractureState {
  std::vector<GrowingFront> fronts;  ///< inside, whether they move or rest
  std::int32_t cracks = 0;           ///< how many have begun, branches included
};

struct FractureStats {
  std::size_t begun = 0, divided = 0, advanced = 0,
              refused = 0;  ///< cracks; branches; steps of fronts; those that could not be made
};

/// Makes one step of a crack in the body, and lets the mechanics follow; false when it cannot be made.
using SplitStep = std::function<bool(FrontState&, const std::vector<Vec3>& next)>;

/// Each live front point works out the stress about it (tip_field) and the direction in which it is largest. Both are
/// smoothed along the front, as a separation tensor. Where the stress passes what the toughness asks for, σ_c, the
/// point goes on at c_max (1 − (σ_c / σ)²), c_max = fracture.speed · rayleigh_speed(), and by a spacing of the nodes at
/// most: the stress must be told anew before it goes farther. Points rest while the stress is less and start again when
/// it rises. A front is moved once it owes a quarter of a spacing. What is ahead of a point that too few nodes see to
/// tell its stress, thinner than half a spacing, parts, and so does a ligament that fronts have left behind at an edge
/// of the body, thinner than a spacing (across_ligament). Then cracks begin where find_starts() says. `part`: per node,
/// its body of the scene. It, `body` and `motion` change through `split` only. The same for any number of threads.
void step_fracture(const Fracture& fracture, const std::vector<std::uint32_t>& part, const Body& body,
                   const Solid& solid, const State& motion, double dt, FractureState& state, const SplitStep& split,
                   FractureStats* work = nullptr);

}  // namespace geo
