// What there is to look at: what one or several files, or the folder of a run, hold together.
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
  geo::TriangleMesh surface;  ///< a surface's own, or a body's two-sided one; may be empty
  std::optional<geo::Body> body;
  std::vector<std::uint32_t> row_of;  ///< of a body: the row in `surface` of each surface vertex id
  geo::NodeSet nodes;                 ///< a node file's, or a body's
  std::vector<geo::Front> fronts;
  geo::TriangleMesh obstacles;       ///< of a run, where they are in its frame
  std::optional<geo::State> motion;  ///< of a run's body: a checkpoint
  int frame = 0;                     ///< of the run, at which `motion` holds
};

/// Reads files of any kind into one subject: at most one with a surface and one with nodes; with a frame of a run the
/// obstacles beside it. Throws InputError.
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
/// The obstacles of each frame, rows alike in all; empty where the run has none. Throws InputError.
std::vector<geo::TriangleMesh> read_obstacles(const Run& run);

}  // namespace view
