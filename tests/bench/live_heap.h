// Heaps of pieces in kerf-live.
#pragma once

#include <string>

#include "bench.h"

namespace bench {

/// Runs kerf-live's session on the model in a file: six strokes across it, a second each. Figures
/// of each second, 0 before the first stroke: pieces, triangles, nodes, time of a frame that does
/// not cut and of one that does.
void heap(const std::string& model, Figures& figures);

}  // namespace bench
