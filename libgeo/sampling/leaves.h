// The leaves of an octree over a solid, each with the position of its node and its share of
// material.
#pragma once

#include <optional>

#include "kerf/nodes.h"
#include "sampling/octree.h"

namespace geo {

/// A leaf with material.
struct Leaf {
  Cell cell;
  Vec3 position = Vec3::Zero();  ///< of its node, strictly inside the material, where it has one
  float share = 0;     ///< of the cell that is material, by 4³ sample points where the surface cuts it; above 0
  bool whole = false;  ///< the surface does not cut it
  bool node = false;   ///< a node fits into it
};

/// Leaves in Morton order, one list after the other.
using LeafLists = std::vector<std::vector<Leaf>>;

/// All leaves with material. The node of a whole leaf is displaced at random about its middle. The
/// node of a cut leaf is near the middle of its material, `keep_off` of the cell's edge away from
/// the surface where possible.
LeafLists find_leaves(const RegionTree& tree, const OctreeShape& shape, const Divisions& divided,
                      const SampleOptions& options, const Progress& progress);

/// Clearance of nodes from the surface where possible, as a share of the cell's edge.
constexpr double keep_off = 0.12;
/// A cell with a smaller share of material gets no node; its volume goes to the nearest node.
/// Larger: fewer nodes with little volume at the surface.
constexpr double least_leaf_share = 0.1;

}  // namespace geo
