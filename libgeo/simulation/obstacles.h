// Contact of objects in the time loop: rigid obstacles, the ground as one of them, and bodies of
// the scene with each other (§ 3.3).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "contact/response/body_contact_penalty.h"
#include "contact/response/obstacle_penalty.h"
#include "kerf/scene.h"
#include "kerf/simulation.h"

namespace geo {

/// The bodies when a time step begins. Refers to everything.
struct ObjectContactStep {
  const Scene& scene;
  const Body& body;
  const Solid& solid;
  const SurfaceWeights& weights;                 ///< of the surface
  std::span<const Vec3> surface;                 ///< per surface vertex, world: its target
  const std::vector<std::uint32_t>& body_index;  ///< per node, its body of the scene
  const State& motion;
  double time, dt;  ///< s
};

/// Owns the potentials of objects in contact.
class Obstacles {
 public:
  /// The scene's obstacles and its ground, the half-space below a plane.
  explicit Obstacles(const Scene& scene);
  /// Whether there is anything that add_potentials() may add.
  bool act(const Scene& scene) const;

  /// Adds the potentials of a time step to `environment`; valid until the next call. Bodies of the
  /// scene repel each other only without self-contact, which includes that.
  void add_potentials(const ObjectContactStep& step, Environment& environment);
  /// Adds to `stats`, after a time step, `share` of the mean forces and torques on the obstacles.
  void add_reactions(const State& motion, double share, FrameStats& stats) const;

 private:
  std::vector<std::shared_ptr<const RigidShape>> shapes_;  // of the scene's obstacles, then of the ground
  std::vector<ObstaclePenalty> obstacles_;                 // of the current step, one for each shape
  std::optional<BodyContactPenalty> body_contact_;         // of the current step
};

}  // namespace geo
