// One time step of fracture by stress: cracks start, grow, branch and arrest.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "kerf/scene.h"
#include "kerf/simulation.h"
#include "kerf/solid.h"
#include "simulation/fracture_front.h"

namespace geo {

/// Moves a front to `next`, one position a point, cuts the body and updates the mechanics. False
/// where the step is refused: front, body and mechanics are then as before.
using SplitStep = std::function<bool(FrontState& front, const std::vector<Vec3>& next)>;

/// Input of a step of fracture. All but the options and dt change through SplitStep, and only
/// through it: references stay valid, copies of sizes do not.
struct FractureInput {
  const FractureOptions& options;
  const std::vector<std::uint32_t>& body_index;  ///< per node: its body of the scene
  const Body& body;
  const Solid& solid;
  const State& motion;  ///< displacements and velocities now
  double dt;            ///< s
};

/// Grows all fronts, cuts ligaments that they leave, then starts new cracks.
///
/// Growth: each live point of a front (GrowingFront::live) takes the stress field around it
/// (tip_field) and the direction of its largest hoop stress σ. The resistance σ_c is the stress of
/// the toughness over a support radius or, without toughness, the strength; both times
/// strength_factor(). The ratio σ / σ_c and the direction are smoothed along the front, as one
/// tensor. Where the ratio exceeds 1, the point grows with speed c_max (1 − (σ_c / σ)²), where
/// c_max = options.speed · rayleigh_speed(). It grows by at most one node spacing in a step, as the
/// stress must be evaluated again before it grows farther.
///
/// Growth is summed over steps (GrowingFront::owed). Once some point owes a quarter of a spacing,
/// the front moves, at the points that owe more than a twentieth. Where the ratio is at most 1 the
/// point is arrested: what it owes is forgotten, and it may grow again later.
///
/// Branches: a front that has grown by options.separation spacings divides where the mean ratio of
/// its live points exceeds options.branching. The branches leave at 30° to either side. A run
/// starts at most options.max_cracks cracks, branches included.
///
/// Ligaments: where too few nodes see a point for its stress, material ahead of it that is thinner
/// than half a spacing is cut, as is a ligament thinner than a spacing at an edge of the body
/// (across_ligament).
///
/// Starts: small cracks at the nodes whose largest principal stress exceeds the strength most, see
/// find_starts() in fracture_start.h. Adds to `stats`. The result is the same for any number of
/// threads.
void step_fracture(const FractureInput& in, FractureState& state, const SplitStep& split,
                   FractureStats* stats = nullptr);

}  // namespace geo
