// Contact of objects in the loop: rigid obstacles, where they are and what bodies do to them; bodies that touch each
// other.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "contact/response/body_contact_penalty.h"
#include "contact/response/obstacle_penalty.h"
#include "kerf/run.h"
#include "kerf/scene.h"

namespace geo {

class Obstacles {
 public:
  /// The scene's obstacles; the ground, too, where surfaces are kept from crossing.
  explicit Obstacles(const Scene& scene);
  /// False: begin() has nothing to look at but bodies that touch each other.
  bool any() const { return !shapes_.empty(); }

  /// Before a step of dt seconds from `time` on: adds them to what acts on nodes, and bodies that touch each other
  /// where nothing else keeps them apart. `part`: per node, its body of the scene. `weights`: of the surface as it is;
  /// none: they are found here. `at`: where they have the surface now; empty: that is found here.
  void begin(const Scene& scene, const Body& body, const Solid& solid, const SurfaceWeights* weights,
             std::span<const Vec3> at, const std::vector<std::uint32_t>& part, const State& motion, double time,
             double dt, Environment& environment);
  /// After a crack step.
  void follow() { own_.reset(); }
  /// After a step: adds `share` of what was done to the scene's obstacles.
  void reaction(const State& motion, double share, FrameStats& work) const;

 private:
  const SurfaceWeights& weights_of(const SurfaceWeights* given, const Body& body, const Solid& solid);
  std::vector<std::shared_ptr<const RigidShape>> shapes_;  // of the scene's obstacles, then that of the ground
  std::vector<ObstaclePenalty> acting_;
  std::optional<BodyContactPenalty> mutual_;
  std::optional<SurfaceWeights> own_;
};

}  // namespace geo
