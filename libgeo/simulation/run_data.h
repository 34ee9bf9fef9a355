// All data of a run, without what computes it.
#pragma once

#include "kerf/body.h"
#include "kerf/scene.h"
#include "kerf/simulation.h"
#include "simulation/cut_solid.h"
#include "simulation/scene_changes.h"

namespace geo {

/// A scene with the values that hold now, its bodies, their state and their mechanics. Places in
/// memory stay, also over restore(). Only a CrackWriter changes the body meanwhile.
struct RunData {
  /// Throws InputError where the state does not fit the scene.
  RunData(const Scene& scene, Body body, RunState state);
  RunData(const RunData&) = delete;
  RunData& operator=(const RunData&) = delete;
  /// Goes to a checkpoint of this run, with the values before the scene's first change. Throws
  /// InputError as the constructor; nothing has changed then.
  void restore(Body new_body, RunState new_state);
  /// Goes on at the present time with another body and state, as a new run of the scene would.
  /// Throws InputError as the constructor; nothing has changed then.
  void become(RunStart other);

  Scene scene;
  SceneChanges changes;
  RunState state;
  Body body;
  CutSolid solid;
};

}  // namespace geo
