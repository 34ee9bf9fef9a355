// The files of a run that other programs read: nodes of a frame, ParaView series (usd_file.h: USD).
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "kerf/body_file.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"
#include "kerf/run.h"

namespace geo {

/// Nodes where they are in a frame of a run: a node file (PLY, floats) with one more field, the
/// stress.
struct FrameNodes {
  NodeSet nodes;               ///< positions moved, all else in material coordinates
  std::vector<double> stress;  ///< per node, von Mises, Pa
};
void write_frame_nodes(std::ostream& out, const FrameNodes& frame);
/// Throws InputError for what is no such file.
FrameNodes parse_frame_nodes(const std::string& bytes, const std::string& name);

/// A series of ParaView's (`.ply.series`, JSON): paths of numbered frames, relative to it, with
/// their times. (A collection, `.pvd`, is of VTK's own formats only.)
void write_series(std::ostream& out, const std::vector<std::string>& frames, double frame_rate);

// ---- The checkpoint of a run: its body and all else that it needs to go on, in one `.kerf` file,
// so that one rename makes it.

struct Checkpoint {
  Body body;
  RunState state;
  std::uint64_t scene = 0;  ///< fingerprint of the scene and its models
};

/// A body as write_body writes it, with sections `run/…` behind it. Deterministic.
void write_checkpoint(std::ostream& out, const Body& body, const RunState& state, std::uint64_t scene);
/// Throws InputError (name first) as read_body does, and for sections of the run that are missing
/// or impossible.
Checkpoint read_checkpoint(const KerfFile& file);

// ---- A run as USD (Universal Scene Description, text form): what film and game pipelines read.

/// Frames of one rate. Each is asked for once, those with new triangles several times where they
/// are many, from any threads; one a thread is in memory, and one more, and the triangles of the
/// first few with new ones.
struct UsdRun {
  std::size_t frames = 0;
  double frame_rate = 24;                            ///< frames a second
  char up = 'Z';                                     ///< the axis that is up: 'Y' or 'Z', as USD knows no other
  std::function<TriangleMesh(std::size_t)> surface;  ///< of the bodies, in metres; its rows may be others in each frame
  std::function<TriangleMesh(std::size_t)> obstacles;  ///< triangles alike in all frames; none: there are no obstacles
};

/// Mesh /run/body with a time sample of points a frame, and of what its triangles are where they
/// change; texture coordinates, where the surface has them; triangles of the skin and those of
/// cracks as subsets bound to materials of their own, and each triangle's crack as primvars:patch.
/// Mesh /run/obstacles.
void write_usda(std::ostream& out, const UsdRun& run);

}  // namespace geo
