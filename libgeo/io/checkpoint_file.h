// The checkpoint of a run: its body and all else that it needs to go on, in one `.kerf` file, so that one rename makes it.
#pragma once

#include <ostream>
#include <string>

#include "io/kerf_reader.h"
#include "simulation/simulation.h"

namespace geo {

struct Checkpoint {
  Body body;
  RunState state;
  std::uint64_t scene = 0;  ///< fingerprint of the scene and its models
};

/// A body as write_body writes it, with sections `run/…` behind it. Deterministic.
void write_checkpoint(std::ostream& out, const Body& body, const RunState& state, std::uint64_t scene);
/// Throws InputError (name first) as read_body does, and for sections of the run that are missing or impossible.
Checkpoint read_checkpoint(const KerfFile& file);

}  // namespace geo
