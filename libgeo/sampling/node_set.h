// Simulation nodes (§ 3.1): positions in material coordinates and what sampling decided about each.
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec.h"

namespace geo {

/// Parallel arrays, one entry a node, in Morton order as sampled; nodes inserted later are appended.
struct NodeSet {
  std::vector<Vec3> position;   ///< strictly inside the material
  std::vector<double> radius;   ///< support radius r_i, model units
  std::vector<double> spacing;  ///< edge length of the octree cell the node stands for, model units
  std::vector<double> volume;   ///< material that the node owns, model units³; sums to the body's volume

  std::size_t size() const { return position.size(); }
};

}  // namespace geo
