// Which pairs of nodes see each other (§ 6.1).
#pragma once

#include <span>
#include <vector>

#include "base/ids.h"
#include "geometry/bvh.h"

namespace geo {

/// Visibility between nodes, exact, with closed semantics: a face that touches the segment blocks it. Most pairs are
/// settled by the empty balls around their nodes. Refers to positions and obstacles, which must outlive it.
class Visibility {
 public:
  /// `reach`: how far from each node the surface is looked for, in model units; pairs farther apart are slower.
  Visibility(std::span<const Vec3> positions, const TriangleBvh& obstacles, std::span<const double> reach);

  /// True when a face touches the closed segment between two nodes. Safe to call from several threads.
  bool blocked(NodeId i, NodeId j) const;
  /// The same for many pairs, in parallel: 1 where blocked.
  std::vector<std::uint8_t> blocked(std::span<const std::pair<NodeId, NodeId>> pairs) const;

 private:
  std::span<const Vec3> positions_;
  const TriangleBvh& obstacles_;
  std::vector<double> clearance_;  // of each node: nothing is closer
};

}  // namespace geo
