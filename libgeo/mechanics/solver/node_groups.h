// Nodes that hang together, in groups of a hundred or so: the coarse bodies of the preconditioner's
// second level.
#pragma once

#include <cstdint>
#include <vector>

#include "mechanics/discretisation/nodal_gradients.h"

namespace geo {

struct NodeGroups {
  std::vector<std::uint32_t> of;    ///< per node
  std::vector<std::uint32_t> part;  ///< per group: the connected part that it belongs to, ascending
  std::size_t count() const { return part.size(); }

  NodeGroups() = default;
  /// Boxes of so many nodes at least, and no more of a connected part than `most_groups` or twice
  /// that, by halves; then what hangs together in a box. Groups of a part are numbered along its
  /// longest side, so that those which touch have numbers near each other.
  NodeGroups(const std::vector<Vec3>& position, const NodalGradientOperator& rows,
             const std::vector<std::uint32_t>& part, std::uint32_t parts, std::size_t fewest = 96,
             std::size_t most_groups = 72);
};

}  // namespace geo
