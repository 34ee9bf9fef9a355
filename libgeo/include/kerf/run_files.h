// Files of a run: nodes of a frame, checkpoints, a ParaView series, and USD.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "kerf/body_file.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"
#include "kerf/run.h"

namespace geo {

// ---- Nodes of a frame.

/// The nodes of a frame.
struct FrameNodes {
  NodeSet nodes;               ///< deformed positions; radius, spacing and volume of the undeformed material
  std::vector<double> stress;  ///< per node, von Mises, Pa
};
/// Writes a node file (binary PLY, single precision) with the stress as a further property.
void write_frame_nodes(std::ostream& out, const FrameNodes& frame);
/// Reads such a file; `name` stands for it in messages. Throws InputError for any other file.
FrameNodes parse_frame_nodes(const std::string& bytes, const std::string& name);

// ---- Checkpoints: the body of a run and its state in one `.kerf` file, replaced by one rename.

struct Checkpoint {
  Body body;
  RunState state;
  std::uint64_t scene = 0;  ///< fingerprint of the scene and its models
};

/// Writes a body as write_body() does, then sections `run/…`. The same run gives the same bytes.
void write_checkpoint(std::ostream& out, const Body& body, const RunState& state, std::uint64_t scene);
/// Reads a checkpoint. Throws InputError as read_body(), and where sections of the run are missing
/// or impossible.
Checkpoint read_checkpoint(const KerfFile& file);

// ---- All frames of a run, for other programs.

/// Writes a ParaView series (`.ply.series`, JSON): paths of numbered frames, relative to the
/// series, and their times. ParaView's collections, `.pvd`, take VTK's own formats only.
void write_series(std::ostream& out, const std::vector<std::string>& frames, double frame_rate);

/// The frames of a run as write_usda() reads them. `surface` and `obstacles` are called from
/// several threads: once for each frame, and several times for frames whose triangles change where
/// there are many. Memory: one frame for each thread and one more, and the triangles of the first
/// few changes.
struct UsdRun {
  std::size_t frames = 0;
  double frame_rate = 24;                              ///< frames per second
  char up = 'Z';                                       ///< vertical axis, 'Y' or 'Z', as USD has no other
  std::function<TriangleMesh(std::size_t)> surface;    ///< of the bodies in a frame, metres
  std::function<TriangleMesh(std::size_t)> obstacles;  ///< in a frame, with the same triangles in all; may be empty
};

/// Writes a run as USD text (Universal Scene Description). The mesh /run/body has a time sample of
/// points for each frame, and of its triangles where they change; texture coordinates where the
/// surface has them; skin and cracks as subsets bound to two materials; and the crack of each
/// triangle as primvars:patch. Obstacles are the mesh /run/obstacles.
void write_usda(std::ostream& out, const UsdRun& run);

}  // namespace geo
