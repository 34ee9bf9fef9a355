// The files of a run: checkpoint, ParaView collection, USD.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "simulation/simulation.h"

namespace geo {

/// Motion and fronts of a run as sections of a container of their own; the body is a .kerf beside it.
void write_run_state(std::ostream& out, const RunState& state);
/// Throws InputError (name first) for anything else than what write_run_state wrote.
RunState read_run_state(const std::string& path);
RunState parse_run_state(const std::string& bytes, const std::string& name);

/// A ParaView collection of numbered frames.
void write_pvd(std::ostream& out, const std::vector<std::string>& frames, double frame_rate);
/// A USD layer whose mesh has time samples of points, counts and indices: topology may change per frame.
void write_usda(std::ostream& out, const std::vector<TriangleMesh>& frames, double frame_rate);

}  // namespace geo
