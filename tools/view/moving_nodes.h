// The nodes of a run in each of its frames, for a page. Every frame has an entry for each node of
// the checkpoint.
#pragma once

#include <kerf/progress.h>
#include "view/subject.h"

namespace view {

struct MovingNodes {
  struct Frame {
    std::size_t count = 0;            ///< nodes of this frame; the others are added later, and are at rest
    std::vector<geo::Vec3> position;  ///< per node
    std::vector<double> stress;       ///< per node, von Mises, Pa; 0 for nodes added later
    std::vector<std::uint32_t>
        piece_of;  ///< per piece of the checkpoint: the piece of the frame's surface that it is a part of
  };
  std::vector<Frame> frames;  ///< one a frame of the run, or none
  double stress_shown = 0;    ///< 99th percentile: the scale of the colours, which crack tips would dominate
};

/// Reads the nodes of all frames. `surfaces`: of the frames. Empty without a checkpoint or node
/// files. Nodes that the checkpoint lacks are left out. Throws InputError for files without nodes
/// of a frame.
MovingNodes read_moving_nodes(const Run& run, const Subject& checkpoint, const std::vector<geo::TriangleMesh>& surfaces,
                              const geo::Progress& progress);

}  // namespace view
