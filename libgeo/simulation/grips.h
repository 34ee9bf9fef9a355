// Nodes held by grips: Dirichlet conditions that move.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "kerf/nodes.h"
#include "kerf/scene.h"
#include "kerf/solid.h"

namespace geo {

/// The nodes in the boxes of a scene's grips. A node in several boxes is held by the first.
class GrippedNodes {
 public:
  /// None.
  GrippedNodes() = default;
  /// The nodes in each grip's box, by their material positions.
  GrippedNodes(const std::vector<Grip>& grips, const NodeSet& nodes);

  /// Marks held nodes in `fixed` (per node, 1: held). Nodes held by a moving grip get the
  /// displacement that the grip has at `time`; the time step then moves all other nodes.
  void place(const std::vector<Grip>& grips, const NodeSet& nodes, double time, std::vector<std::uint8_t>& fixed,
             State& motion) const;

  /// Gives held nodes of moving grips the mean velocity of their grip from `time` to `time` + dt.
  void set_velocities(const std::vector<Grip>& grips, const NodeSet& nodes, const std::vector<std::uint8_t>& fixed,
                      double time, double dt, State& motion) const;

 private:
  std::vector<std::pair<NodeId, std::size_t>> held_;  // ascending: node, grip
};

}  // namespace geo
