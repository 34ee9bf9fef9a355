// Checkpoints in memory: a run that goes on from one equals a run that was resumed from its file.
#pragma once

#include <string>

#include <kerf/progress.h>
#include <kerf/simulation.h>
#include "sim/setup.h"

namespace sim {

/// A checkpoint, as a file has it.
std::string checkpoint_bytes(const geo::Body& body, const geo::RunState& state, std::uint64_t fingerprint);
/// The checkpoint of a run before its first step. Throws as geo::begin_run().
std::string first_checkpoint(const Setup& setup, const geo::Progress& progress);
/// The run of a scene that continues from a checkpoint. Throws geo::InputError where it does not
/// fit the scene.
geo::Simulation run_from(const geo::Scene& scene, const std::string& checkpoint);

}  // namespace sim
