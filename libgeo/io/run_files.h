// The files of a run that other programs read: nodes of a frame, ParaView series (usd_file.h: USD).
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

/// A series of ParaView's (`.ply.series`, JSON): paths of numbered frames, relative to it, with their times. (A collection, `.pvd`, is of
/// VTK's own formats only.)
void write_series(std::ostream& out, const std::vector<std::string>& frames, double frame_rate);

}  // namespace geo
