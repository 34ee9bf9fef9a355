// The loop over time steps: nodes move, the surface follows, blades cut, cracks grow by stress and
// glued bonds break.
#pragma once

#include <optional>
#include <vector>

#include "kerf/progress.h"
#include "kerf/simulation.h"
#include "simulation/blade_cuts.h"
#include "simulation/bond_breaker.h"
#include "simulation/cohesive_walls.h"
#include "simulation/collisions.h"
#include "simulation/crack_writer.h"
#include "simulation/edge_resistance.h"
#include "simulation/node_loads.h"
#include "simulation/obstacles.h"
#include "simulation/run_data.h"
#include "simulation/skin_loads.h"
#include "simulation/sleep.h"

namespace geo {

/// Computes frames of a run. Refers to the run, and alone changes its body. After
/// RunData::restore() a new loop takes its place.
class TimeLoop {
 public:
  /// Goes on from the run's time. Throws InputError where the run's surface does not fit its body,
  /// or a load of the scene has no skin to act on.
  explicit TimeLoop(RunData& run);

  /// See Simulation::advance_frame().
  FrameStats advance_frame(const Progress& progress);
  /// The scene's list of grips has changed.
  void follow_grips() {
    loads_.follow_scene();
    sleep_.wake_all();
  }
  /// The deformed surface.
  const Collisions& collisions() const { return collisions_; }

 private:
  bool apply_changes(double time);
  template <class Time>
  void advance(int step, double dt, const Time& time, FrameStats& stats);
  // The fate of a time step. One that was not taken has changed nothing.
  enum class Outcome { taken, too_long, not_found };
  Outcome step(const TimeStep& step, FrameStats& stats);
  void sleep_on(const TimeStep& step, FrameStats& stats);
  void add_obstacle_forces(double share, FrameStats& stats) const;
  void add_obstacles(const TimeStep& step, double stopping);
  void add_edges(const TimeStep& step);
  std::optional<ContactStep> begin_contact(const TimeStep& step, FrameStats& stats);
  StepReport move_nodes(const TimeStep& step, FrameStats& stats);
  void take(const StepReport& report, const TimeStep& step, FrameStats& stats);
  bool is_too_long(const TimeStep& step, const State& before, FrameStats& stats);
  void move_surface(const TimeStep& step, std::optional<ContactStep> contact, const std::vector<Vec3>& before,
                    FrameStats& stats);
  void cut(const TimeStep& step, FrameStats& stats);
  void grow_cracks(double dt, FrameStats& stats);
  bool may_break() const;
  void break_bonds(double dt, FrameStats& stats);
  void hold_material(double time);
  MovedBody moved_body(const TimeStep& step) const;

  RunData& run_;
  Obstacles obstacles_;
  NodeLoads loads_;
  Collisions collisions_;
  NodeWay way_;  // of this time step, while blades cut
  CrackWriter writer_;
  BladeCuts cuts_;
  BondBreaker bonds_;
  CohesiveWalls cohesion_;
  SkinLoads skin_;
  EdgeResistance edges_;
  Sleep sleep_;
  FrameStats last_step_;  // forces and energy of the last computed step; no steps: none was
};

}  // namespace geo
