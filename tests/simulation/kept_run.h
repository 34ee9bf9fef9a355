// A run written as kerf-sim keeps it, and taken up again from those bytes.
#pragma once

#include <sstream>
#include <string>

#include "kerf/run_files.h"
#include "kerf/simulation.h"

namespace geo {

/// Without the seconds that it took: the same for the same run.
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
