// The loop of § 3.3 and § 4: blades move, fronts follow into the material, the body is split, nodes move, surface
// follows.
#pragma once

#include <cstddef>
#include <vector>

#include "contact/response/blade_penalty.h"
#include "kerf/body.h"
#include "kerf/run.h"
#include "kerf/scene.h"
#include "kerf/solid.h"
#include "simulation/collisions.h"
#include "simulation/fracture_step.h"
#include "simulation/obstacles.h"
#include "simulation/run_state.h"

namespace geo {

class Simulation {
 public:
  /// A fresh run; throws as begin_run() does.
  Simulation(const Scene& scene, const Model& model, const Progress& progress = {});
  /// The same for a scene of one body that stands where it was modelled.
  Simulation(const Scene& scene, const TriangleMesh& solid, const Progress& progress = {});
  /// A run taken up again; without parts all nodes are of the first body. Throws InputError when the state is not of
  /// this scene.
  Simulation(const Scene& scene, Body body, RunState state);
  /// This run from its own body and state as a file gave them back: from there on the same as a run taken up from that
  /// file. What no cut has changed since the run began, or was taken up last, is kept.
  void take_up(Body body, RunState state);

  /// Time steps up to the next frame. Throws GeometryError when the motion is no longer finite, Interrupted when
  /// `progress` says so. A crack step that is refused is counted, and its front tried again in the next step.
  FrameStats advance_frame(const Progress& progress = {});

  /// The deformed two-sided surface (Eq. 1, but for what contact holds back), patch, site and source included. With the
  /// model of the run it also has the model's attributes, except normals: these change with the shape.
  TriangleMesh surface(const TriangleMesh* model = nullptr) const;
  const Body& body() const { return body_; }
  const RunState& state() const { return state_; }
  const Solid& solid() const { return solid_; }

 private:
  Simulation(const Scene& scene, Beginning begun);
  void step(double dt, FrameStats& work);
  void cut(double dt, FrameStats& work);
  void cut_at(std::size_t blade, double time, FrameStats& work);
  std::int32_t next_crack() const;
  std::vector<Pose> grip_poses(double time) const;
  void move_grips(double dt);
  void integrate(double dt, FrameStats& work);
  void push(double dt);
  void meet_obstacles(double dt, FrameStats& work);
  void collide(const std::vector<Vec3>& before, double dt, FrameStats& work);
  void fracture(double dt, FrameStats& work);
  void adopt(const BodyDelta& delta, FrameStats& work);
  /// One step of a crack, which the mechanics follows; false, and counted, when it is refused.
  bool split_step(FrontState& front, const std::vector<Vec3>& next, FrameStats& work);
  void begin();
  void prepare();

  Scene scene_;
  RunState state_;
  Body body_;
  Solid solid_;
  Environment environment_;
  BladePenalty wedge_;
  Obstacles obstacles_;
  std::optional<Collisions> collisions_;
  std::vector<std::pair<NodeId, std::size_t>> gripped_;  // ascending: node, grip
  bool cut_ = false;                                     // since the solid was made
};

}  // namespace geo
