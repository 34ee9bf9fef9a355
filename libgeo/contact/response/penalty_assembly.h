// Assembles the self-contact potential of one implicit time step from the predicted motion of the
// surface (§ 3.3).
#pragma once

#include <vector>

#include "contact/detection/broad_phase.h"
#include "contact/response/self_contact_penalty.h"
#include "contact/surface/moving_surface.h"
#include "contact/surface/surface_weights.h"

namespace geo {

/// Motion of the nodes in a time step if only inertia and gravity acted.
struct FreeMotion {
  std::vector<double> inverse_mass;  ///< per node, 1/kg; fixed nodes included
  std::vector<Vec3> displacement;    ///< per node, at the end of the step
  double mean_spacing = 0;           ///< of nodes, model units
};

/// The free motion of a step of dt seconds that begins at `state`, by the gravity of `environment`.
/// Its fixed nodes stay where they are.
FreeMotion free_motion(const Body& body, const Solid& solid, const State& state, double dt,
                       const Environment& environment);

/// The beginning of a step and its prediction. Refers to everything.
struct PenaltyInput {
  const Body& body;
  const Solid& solid;
  const SurfaceWeights& weights;
  const std::vector<Vec3>& displacement;  ///< per node, at the beginning
  const FreeMotion& free;
  const std::vector<Vec3>& targets;       ///< per surface vertex, at the beginning
  const std::vector<Vec3>& mean_targets;  ///< Coincidence::averaged() of these
  const std::vector<Vec3>& free_targets;  ///< per surface vertex, at the end of the free motion
  double dt = 0;                          ///< s
  double stopping = 0;                    ///< s: in which a contact stops what comes at it
  double made_good = 0;                   ///< share of an existing separation deficit that the step makes good
  double gap = 0;                         ///< distance that surfaces in contact keep, model units
};

/// Adds to `penalty` the contacts that the free motion may close: pairs of surface points that come
/// near each other, and the two sides of closed sheets. `near`: is left with the broad phase's
/// pairs.
void assemble_penalty(const PenaltyInput& input, MovingSurface& surface, BroadPhase& near, SelfContactPenalty& penalty);

}  // namespace geo
