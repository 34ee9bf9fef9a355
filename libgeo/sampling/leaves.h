// The leaves of an octree over a solid, each with the place of its node and its share of material.
#pragma once

#include <optional>

#include "kerf/nodes.h"
#include "sampling/octree.h"

namespace geo {

struct Leaf {
  Cell cell;
  Vec3 position = Vec3::Zero();  ///< of its node, strictly inside the material, where it has one
  float share = 0;     ///< of the cell that is material, by 4³ sample points where the surface cuts it; above 0
  bool whole = false;  ///< no surface in it
  bool node = false;
};

/// Leaves in Morton order, one list after the other.
using LeafLists = std::vector<std::vector<Leaf>>;

/// All leaves with material. A whole leaf's node is displaced at random about its middle, a cut one's about the middle
/// of its material, off the surface by an eighth of the cell where there is room.
LeafLists find_leaves(const RegionTree& tree, const OctreeShape& shape, const Divisions& divided,
                      const SampleOptions& options, const Progress& progress);

/// The part of its cell's edge that a node keeps off the surface where it can.
constexpr double keep_off = 0.12;
/// A cell with less material than this share gives it to its neighbours.
constexpr double least_share = 0.1;

}  // namespace geo
