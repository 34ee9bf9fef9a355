// The files about all frames of a run: a ParaView series, a USD file.
#pragma once

#include "sim/run_folder.h"

namespace sim {

/// Of frames 0 to `last`, which are in the folder, as are their obstacles if there are any. Throws OutputError, InputError.
void write_whole_run(const RunFolder& folder, int last, double frame_rate);

}  // namespace sim
