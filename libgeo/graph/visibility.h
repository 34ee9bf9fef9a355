// Visibility between pairs of nodes (§ 6.1).
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "geometry/bvh.h"
#include "kerf/vec.h"

namespace geo {

/// Exact visibility between nodes with closed semantics: a face that touches the segment blocks it.
/// Safe to use from several threads.
class Visibility {
 public:
  /// Refers to positions and obstacles, which must outlive it.
  Visibility(std::span<const Vec3> positions, const TriangleBvh& obstacles)
      : positions_(positions), obstacles_(obstacles) {}

  /// True when a face touches the closed segment between two nodes.
  bool blocked(NodeId i, NodeId j) const { return obstacles_.blocks(positions_[i.index()], positions_[j.index()]); }
  /// The same for segments from one node, which share the search. `result` is as long as `to`; 1:
  /// blocked.
  void blocked(NodeId i, std::span<const NodeId> to, std::span<std::uint8_t> result) const;
  /// The same for many pairs, in parallel; 1: blocked. Fast where pairs with the same first node
  /// are adjacent.
  std::vector<std::uint8_t> blocked(std::span<const std::pair<NodeId, NodeId>> pairs) const;

 private:
  std::span<const Vec3> positions_;
  const TriangleBvh& obstacles_;
};

}  // namespace geo
