// The files about all frames of a run: a ParaView series, a USD file.
#pragma once

#include "sim/run_folder.h"

namespace sim {

/// The axis that is up for USD: Y where gravity goes straight against it, else Z.
char up_axis(const geo::Vec3& gravity);

/// Of frames 0 to `last`, which are in the folder, as are their obstacles if there are any. Throws OutputError,
/// InputError.
void write_whole_run(const RunFolder& folder, int last, double frame_rate, char up);

}  // namespace sim
