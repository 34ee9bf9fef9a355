// A checkpoint is written and read back, so that every run begins from the same bits.
#include "sim/start.h"

#include <sstream>
#include <utility>

#include <kerf/body_file.h>

namespace sim {

std::string checkpoint_bytes(const geo::Body& body, const geo::RunState& state, std::uint64_t fingerprint) {
  std::ostringstream out;
  geo::write_checkpoint(out, body, state, fingerprint);
  return std::move(out).str();
}

std::string first_checkpoint(const Setup& setup, const geo::Progress& progress) {
  const geo::RunStart fresh = geo::begin_run(setup.scene, setup.models, progress);
  return checkpoint_bytes(fresh.body, fresh.state, setup.fingerprint);
}

geo::Simulation run_from(const geo::Scene& scene, const std::string& checkpoint) {
  geo::Checkpoint c = geo::read_checkpoint(geo::KerfFile(geo::Input(checkpoint, "checkpoint")));
  return {scene, std::move(c.body), std::move(c.state)};
}

}  // namespace sim
