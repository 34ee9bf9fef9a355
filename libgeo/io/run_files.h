// The files of a run that other programs read: nodes of a frame, ParaView collection (usd_file.h: USD).
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "sampling/node_set.h"

namespace geo {

/// Nodes where they are in a frame of a run: a node file (PLY, floats) with one more field, the stress.
struct FrameNodes {
  NodeSet nodes;               ///< positions moved, all else in material coordinates
  std::vector<double> stress;  ///< per node, von Mises, Pa
};
void write_frame_nodes(std::ostream& out, const FrameNodes& frame);
/// Throws InputError for what is no such file.
FrameNodes parse_frame_nodes(const std::string& bytes, const std::string& name);

/// A ParaView collection: of each part its numbered frames.
void write_pvd(std::ostream& out, const std::vector<std::vector<std::string>>& parts, double frame_rate);

}  // namespace geo
