// Which pairs of nodes see each other (§ 6.1).
#pragma once

#include <span>
#include <vector>

#include "geometry/bvh.h"
#include "kerf/vec.h"

namespace geo {

/// Visibility between nodes, exact, with closed semantics: a face that touches the segment blocks it. Refers to
/// positions and obstacles, which must outlive it. Safe to use from several threads.
class Visibility {
 public:
  Visibility(std::span<const Vec3> positions, const TriangleBvh& obstacles)
      : positions_(positions), obstacles_(obstacles) {}

  /// True when a face touches the closed segment between two nodes.
  bool blocked(NodeId i, NodeId j) const { return obstacles_.blocks(positions_[i.index()], positions_[j.index()]); }
  /// The same for many segments from one node, which share the search: 1 in `result`, as long as `to`, where blocked.
  void blocked(NodeId i, std::span<const NodeId> to, std::span<std::uint8_t> result) const;
  /// The same for many pairs, in parallel: 1 where blocked. Fast where pairs with the same first node follow each
  /// other.
  std::vector<std::uint8_t> blocked(std::span<const std::pair<NodeId, NodeId>> pairs) const;

 private:
  std::span<const Vec3> positions_;
  const TriangleBvh& obstacles_;
};

}  // namespace geo
