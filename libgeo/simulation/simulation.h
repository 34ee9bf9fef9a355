// The loop of § 3.3 and § 4: blades move, fronts follow into the material, the body is split, nodes move, surface follows.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "body/body.h"
#include "simulation/fracture_step.h"
#include "simulation/scene.h"

namespace geo {

/// Counts and seconds, by phase, of one frame or of many.
struct FrameWork {
  SplitWork split;
  FractureWork fracture;
  std::size_t refused = 0, newton = 0, cg = 0, steps = 0;
  double front_seconds = 0, mechanics_seconds = 0, surface_seconds = 0, fracture_seconds = 0;  ///< fracture's: stresses and plans, its splits apart
  FrameWork& operator+=(const FrameWork& o);
};

/// What a run needs to go on besides its body.
struct RunState {
  State motion;
  std::vector<std::optional<FrontState>> fronts;  ///< per blade
  FractureState fracture;
  double time = 0;
  int frame = 0;
};

class Simulation {
 public:
  /// A fresh run: samples and builds the body of `solid`.
  Simulation(const Scene& scene, const TriangleMesh& solid, const Progress& progress = {});
  /// A run taken up again.
  Simulation(const Scene& scene, Body body, RunState state);

  /// Time steps up to the next frame. Throws GeometryError when the motion is no longer finite. A crack step that is
  /// refused is counted, and its front tried again in the next step.
  FrameWork advance_frame();

  /// The deformed two-sided surface (Eq. 1), patch, site and source included. With the model of the run it also has the
  /// model's attributes, except normals: these change with the shape.
  TriangleMesh surface(const TriangleMesh* model = nullptr) const;
  const Body& body() const { return body_; }
  const RunState& state() const { return state_; }
  const Solid& solid() const { return solid_; }

 private:
  void prepare();
  void cut(FrameWork& work);
  void fracture(FrameWork& work, double dt);
  /// One step of a crack, which the mechanics follows; false, and counted, when it is refused.
  bool split_step(FrontState& front, const std::vector<Vec3>& next, FrameWork& work);

  Scene scene_;
  Body body_;
  RunState state_;
  Solid solid_;
  Environment environment_;
};

}  // namespace geo
