// Contact with rigid objects in the time loop: obstacles, and the ground as one of them (§ 3.3).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "contact/response/obstacle_penalty.h"
#include "kerf/scene.h"
#include "kerf/simulation.h"
#include "simulation/node_loads.h"

namespace geo {

/// The bodies when a time step begins. Refers to everything.
struct ObjectContactStep {
  const Scene& scene;
  const Body& body;
  const Solid& solid;
  const SurfaceWeights& weights;  ///< of the surface
  std::span<const Vec3> surface;  ///< per surface vertex, world: its target
  const State& motion;
  double time, dt;  ///< s
  double stopping;  ///< s: see ContactPace
};

/// Owns the potentials of objects in contact.
class Obstacles {
 public:
  /// The scene's obstacles and its ground, the half-space below a plane.
  explicit Obstacles(const Scene& scene);
  /// Whether there is an obstacle or a ground.
  bool any() const { return !shapes_.empty(); }

  /// Adds the potentials of a time step to `environment`; valid until the next call.
  void add_potentials(const ObjectContactStep& step, Environment& environment);
  /// The potentials of add_potentials() whose obstacles move in the step.
  std::vector<const Potential*> moving() const;
  /// Whether an obstacle moves in a time step.
  static bool any_moves(const Scene& scene, const TimeStep& step);
  /// Adds to `stats`, after a time step, `share` of the mean forces and torques on the obstacles.
  void add_reactions(const State& motion, double share, FrameStats& stats) const;

 private:
  std::vector<std::shared_ptr<const RigidShape>> shapes_;  // of the scene's obstacles, then of the ground
  std::vector<ObstaclePenalty> obstacles_;                 // of the current step, one for each shape
};

}  // namespace geo
