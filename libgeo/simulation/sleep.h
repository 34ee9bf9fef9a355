// Sleep: pieces that have come to rest are not computed until something wakes them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/scene.h"
#include "kerf/simulation.h"
#include "kerf/solid.h"

namespace geo {

/// Which parts of the bodies sleep. Components of the graph whose boxes meet are a cluster. It
/// rests while each of its nodes stays within a twentieth of a spacing of a place, and sleeps after
/// Scene::sleep seconds of that, unless something in it flies or flows. It wakes where it is cut,
/// where its clamps move, where anything but weight and what stands still acts on it, and where
/// something that is awake comes near. Refers to scene and state.
class Sleep {
 public:
  /// Sleep in a run whose scene has it.
  Sleep(const Scene& scene, RunState& state) : scene_(scene), state_(state) {}
  /// Whether anything may sleep: in implicit steps, where nothing is to break.
  bool on() const;

  /// Begins a time step of dt seconds, of which `environment` has all but contact; marks and clamps
  /// there what sleeps. Awake are components with a node that is not where `before`, displacements
  /// at the step's beginning, have it, and those that a potential of `environment` acts on.
  void begin_step(const Solid& solid, const std::vector<Vec3>& before, double dt, Environment& environment);
  /// Whether all nodes sleep in this step.
  bool all() const { return all_; }
  /// Wakes what a potential acts on, in this step.
  void wake(const Solid& solid, const Potential& potential, Environment& environment);
  /// Ends a time step of dt seconds: counts for how long components have rested. Those that fall
  /// asleep lose what velocity they have.
  void end_step(const Solid& solid, double dt);

  /// The components of these nodes wake before the next step.
  void wake(std::span<const NodeId> nodes);
  /// All wake before the next step.
  void wake_all() { state_.rest = {}; }

 private:
  void mark_sleepers(const Solid& solid, Environment& environment);

  const Scene& scene_;
  RunState& state_;
  std::vector<std::uint8_t> clamped_;  // per node: by the environment, before what sleeps
  double dt_ = 0;                      // s: of this step
  bool all_ = false;
};

}  // namespace geo
