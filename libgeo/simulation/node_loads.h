// Loads on the nodes in a time step, except contact of surfaces: weight, grips, the wedges of
// blades, pulls, stitches.
#pragma once

#include "contact/response/blade_penalty.h"
#include "kerf/body.h"
#include "kerf/scene.h"
#include "kerf/simulation.h"
#include "kerf/solid.h"
#include "simulation/grips.h"
#include "simulation/pulls.h"
#include "simulation/stitches.h"

namespace geo {

/// A time step. Its end is the begin of the next, to the bit: there, motions have their keys.
struct TimeStep {
  double begin, end, dt;  ///< s
};

/// Makes the environment of each time step. Refers to the scene and the body; solids are those of
/// the body, of which it uses the nodes.
class NodeLoads {
 public:
  /// For nodes and scene as they are now.
  NodeLoads(const Scene& scene, const Body& body);
  /// The scene's weight or its list of grips has changed.
  void follow_scene();
  /// The body has taken a crack step.
  void follow_crack();

  /// Begins a time step: places the nodes that moving grips hold, and makes the environment anew.
  void begin_step(const TimeStep& step, const Solid& solid, State& motion);
  /// Weight, held nodes, wedges, pulls and stitches since begin_step(); contact may be added until
  /// the next.
  Environment& environment() { return environment_; }
  /// Ends a time step: held nodes get the velocity of their grips. Adds to `stats` the `share` of
  /// the forces on blades, pulls and stitches.
  void end_step(const TimeStep& step, double share, State& motion, FrameStats& stats);

 private:
  void add_wedges(const TimeStep& step, const Solid& solid, const State& motion);

  const Scene& scene_;
  const Body& body_;
  Environment environment_;
  GrippedNodes gripped_;
  BladePenalty wedges_;
  PullPotential pulls_;
  StitchPotential stitches_;
  bool is_behind_ = false;  // nodes have changed since follow_scene()
};

}  // namespace geo
