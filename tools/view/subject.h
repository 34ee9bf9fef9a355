// The content of one or several files, or of the folder of a run, that is drawn together.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <kerf/body.h>
#include <kerf/crack.h>
#include <kerf/nodes.h>
#include <kerf/solid.h>

namespace view {

struct Subject {
  std::string title;
  geo::TriangleMesh surface;  ///< from a surface file, or two-sided from a body; may be empty
  std::optional<geo::Body> body;
  std::vector<std::uint32_t> row_of;  ///< of a body: index in `surface` of each surface vertex
  geo::NodeSet nodes;                 ///< from a node file, or a body
  std::vector<geo::Front> fronts;
  geo::TriangleMesh obstacles;       ///< of a run, in its frame
  std::optional<geo::State> motion;  ///< of the body, from a checkpoint
  int frame = 0;                     ///< frame of `motion`
};

/// Reads files of any kind into one subject: at most one with a surface and one with nodes. A frame
/// of a run brings the obstacles beside it. Throws InputError.
Subject read_subject(const std::vector<std::string>& paths);

/// The folder of a run, or one of numbered surfaces.
struct Run {
  std::string title;
  std::vector<std::string> frames;  ///< paths, in order
  std::vector<std::string> nodes;   ///< paths of each frame's nodes, or empty
  std::string body;                 ///< the checkpoint's path, or empty
  bool y_up = false;                ///< as its run.usda says
};
/// Throws InputError when the folder holds no frames.
Run find_run(const std::string& folder);
/// The checkpoint's body with its motion; empty where the run has none.
Subject read_checkpoint(const Run& run);
/// The obstacles of each frame, with equal triangles; empty where the run has none. Throws
/// InputError.
std::vector<geo::TriangleMesh> read_obstacles(const Run& run);

}  // namespace view
