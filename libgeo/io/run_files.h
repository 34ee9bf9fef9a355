// The files of a run that other programs read: nodes of a frame, ParaView collection, USD.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "sampling/node_set.h"
#include "surface/triangle_mesh.h"

namespace geo {

/// Nodes where they are in a frame of a run: a node file (PLY, floats) with one more field, the stress.
struct FrameNodes {
  NodeSet nodes;               ///< positions moved, all else in material coordinates
  std::vector<double> stress;  ///< per node, von Mises, Pa
};
void write_frame_nodes(std::ostream& out, const FrameNodes& frame);
/// Throws InputError for what is no such file.
FrameNodes parse_frame_nodes(const std::string& bytes, const std::string& name);

/// A ParaView collection of numbered frames.
void write_pvd(std::ostream& out, const std::vector<std::string>& frames, double frame_rate);
/// A USD layer whose mesh has time samples of points, counts and indices: topology may change per frame. `frame` gives each
/// of `count` frames, three times; one is in memory at a time.
void write_usda(std::ostream& out, std::size_t count, const std::function<TriangleMesh(std::size_t)>& frame, double frame_rate);

}  // namespace geo
