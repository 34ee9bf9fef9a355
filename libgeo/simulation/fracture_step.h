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

/// Makes one step of a crack in the body and updates the mechanics; false where it cannot be made.
using SplitStep = std::function<bool(FrontState& front, const std::vector<Vec3>& next)>;

/// Input of a step of fracture. `body`, `body_index` and `motion` change through SplitStep only.
struct FractureInput {
  const FractureOptions& options;
  const std::vector<std::uint32_t>& body_index;  ///< per node: its body of the scene
  const Body& body;
  const Solid& solid;
  const State& motion;
  double dt;  ///< s
};

/// Grows all fronts, cuts ligaments that they leave, then starts new cracks.
///
/// Growth: each live point of a front takes the stress field around it (tip_field) and the
/// direction of its largest hoop stress σ. Both are smoothed along the front as a tensor. Where σ
/// exceeds the resistance σ_c, which the toughness gives, the point grows with speed c_max (1 −
/// (σ_c / σ)²), where c_max = options.speed · rayleigh_speed(). It grows by at most one node
/// spacing in a step, as the stress must be evaluated again before it grows farther. A front moves
/// once it owes a quarter of a spacing. Points with less stress are arrested and may grow again
/// later.
///
/// Ligaments: where too few nodes see a point for its stress, material ahead of it that is thinner
/// than half a spacing is cut, as is a ligament thinner than a spacing at an edge of the body
/// (across_ligament).
///
/// Starts: where find_starts() finds them. The result is the same for any number of threads.
void step_fracture(const FractureInput& in, FractureState& state, const SplitStep& split,
                   FractureStats* stats = nullptr);

}  // namespace geo
