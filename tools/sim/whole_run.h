// The files about all frames of a run: a ParaView series and a USD file.
#pragma once

#include <string>
#include <vector>

#include "sim/run_folder.h"

namespace sim {

/// The vertical axis for USD: Y where gravity points along −y exactly, else Z.
char up_axis(const geo::Vec3& gravity);

/// Writes both for frames 0 to `last`, which are in the folder with their obstacles, if any, and
/// the images of the run's materials, run_NAME.png. Returns what USD does not hold of these. Throws
/// OutputError, InputError.
std::vector<std::string> write_whole_run(const RunFolder& folder, int last, double frame_rate, char up);

}  // namespace sim
