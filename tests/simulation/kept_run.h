// Checkpoints of a run as bytes, and runs resumed from them.
#pragma once

#include <sstream>
#include <string>

#include "kerf/body_file.h"
#include "kerf/simulation.h"

namespace geo {

/// The checkpoint without statistics: equal for equal runs.
inline std::string bytes(const Simulation& sim) {
  std::ostringstream out;
  RunState state = sim.state();
  state.total = {};
  write_checkpoint(out, sim.body(), state, 0);
  return out.str();
}

inline Simulation read_back(const Scene& scene, const std::string& bytes) {
  Checkpoint c = read_checkpoint(KerfFile(Input(bytes, "checkpoint")));
  return Simulation(scene, std::move(c.body), std::move(c.state));
}

}  // namespace geo
