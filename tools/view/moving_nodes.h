// The nodes of a run in each of its frames, made ready for a page: as many rows in each as there are nodes in the end.
#pragma once

#include <kerf/progress.h>
#include "view/subject.h"

namespace view {

struct MovingNodes {
  struct Frame {
    std::size_t count = 0;            ///< of nodes that there are; those behind are of later frames, and stand at rest
    std::vector<geo::Vec3> position;  ///< per node
    std::vector<double> stress;       ///< per node, von Mises, Pa; 0 for those behind
    std::vector<std::uint32_t>
        piece_of;  ///< per piece of the checkpoint: the piece of the frame's surface that it is a part of
  };
  std::vector<Frame> frames;  ///< one a frame of the run, or none
  double stress_shown = 0;    ///< that 99 of 100 nodes do not pass: crack tips would darken all else
};

/// Of a run with nodes for each frame and a checkpoint; `surfaces`: its frames. Throws InputError for files that hold
/// no nodes of a frame. Nodes that the checkpoint does not have are left out.
MovingNodes read_moving_nodes(const Run& run, const Subject& checkpoint, const std::vector<geo::TriangleMesh>& surfaces,
                              const geo::Progress& progress);

}  // namespace view
