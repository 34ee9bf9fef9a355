// Self-contact for time steps whose forces ignore contact: impulses on the nodes after the step
// (§ 3.3).
#pragma once

#include <vector>

#include "contact/detection/broad_phase.h"
#include "contact/surface/moving_surface.h"
#include "contact/surface/surface_weights.h"
#include "kerf/solid.h"

namespace geo {

/// A finished step of the nodes. Refers to everything.
struct StepWithoutContact {
  const Solid& solid;
  const SurfaceWeights& weights;
  const std::vector<Vec3>& before;         ///< displacements per node when the step began
  double dt;                               ///< s
  const std::vector<std::uint8_t>& fixed;  ///< per node, or empty; fixed nodes have infinite mass
};

/// Parameters of the response.
struct ImpulseResponseOptions {
  double gap;       ///< distance that surfaces in contact keep, model units
  double friction;  ///< Coulomb's coefficient
  double recovery;  ///< share of a penetration that one step takes back
  int rounds;       ///< at most, of finding contacts and applying impulses
};

/// Changes displacements and velocities of `state`, the end of the step, so that surface points
/// stop approaching each other. Then brings back points that passed each other, by displacements
/// alone. Momentum is conserved but for fixed nodes. `near`: is left with the broad phase's
/// pairs. Returns the number of contacts, summed over the rounds.
std::size_t resolve_with_impulses(const StepWithoutContact& step, const ImpulseResponseOptions& options,
                                  MovingSurface& surface, BroadPhase& near, State& state);

}  // namespace geo
