// Nodes held by grips: Dirichlet conditions that move.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "kerf/nodes.h"
#include "kerf/scene.h"
#include "kerf/solid.h"

namespace geo {

/// The nodes in the boxes of a scene's grips. A node in several boxes is held by the first that
/// exists at the time.
class GrippedNodes {
 public:
  /// Whether other grips hold at the end of a time step than at its beginning, s.
  static bool change(const std::vector<Grip>& grips, double begin, double end);
  /// None.
  GrippedNodes() = default;
  /// The nodes in each grip's box, by their material positions.
  GrippedNodes(const std::vector<Grip>& grips, const NodeSet& nodes);

  /// Marks held nodes in `fixed` (per node, 1: held). Nodes held by a moving grip get the
  /// displacement that the grip has at `time`; the time step then moves all other nodes.
  void place(const std::vector<Grip>& grips, const NodeSet& nodes, double time, std::vector<std::uint8_t>& fixed,
             State& motion) const;

  /// The boxes of the grips that exist at `time`, for Solid::hold(), in the scene's order. A grip
  /// without keys that begins after time 0 holds nodes where they then are, and one that has
  /// released its nodes holds none: no rigid motion.
  static std::vector<HeldBox> boxes(const std::vector<Grip>& grips, double time);

  /// Gives held nodes of moving grips the mean velocity of their grip from `begin` to `end`.
  void set_velocities(const std::vector<Grip>& grips, const NodeSet& nodes, double begin, double end,
                      State& motion) const;

 private:
  // Calls each(node, grip) for the nodes that are held at a time.
  template <class Each>
  void each_held(const std::vector<Grip>& grips, double time, const Each& each) const;
  std::vector<std::pair<NodeId, std::size_t>> inside_;  // ascending: node, grip
};

}  // namespace geo
