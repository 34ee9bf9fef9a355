// A body's file with further sections behind it, as a checkpoint has.
#pragma once

#include <ostream>
#include <vector>

#include "io/kerf_writer.h"
#include "kerf/body.h"

namespace geo {

/// Writes a body as write_body() does, then `more`, which readers of bodies ignore.
void write_body_with(std::ostream& out, const Body& body, const std::vector<KerfArray>& more);

}  // namespace geo
