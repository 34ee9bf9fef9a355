// Leaves at a given spacing, and the spacing that gives a wanted number of nodes.
#pragma once

#include "sampling/leaves.h"

namespace geo {

/// Decides which leaves get a node: a leaf with a larger share of material than `share`, or with
/// the same share and a ticket of at least `ticket`.
struct NodeSelection {
  float share = float(least_leaf_share);
  std::uint64_t ticket = 0;
  /// The ticket of a leaf: a hash of its cell.
  static std::uint64_t ticket_of(const Leaf& leaf);
  /// Does the leaf get a node?
  bool operator()(const Leaf& leaf) const {
    return leaf.node && (leaf.share != share ? leaf.share > share : ticket_of(leaf) >= ticket);
  }
};

/// Leaves at one spacing.
struct SpacedLeaves {
  LeafLists lists;          ///< all leaves with material
  Lattice lattice;          ///< of their cells
  ThinPlaces thin;          ///< thinnest walls
  NodeSelection selection;  ///< leaves that get a node
};

/// Finds leaves over one solid at any spacing.
class LeafFinder {
 public:
  /// Copies the solid.
  LeafFinder(const TriangleMesh& solid, const SampleOptions& options, const Progress& progress)
      : tree_(solid), box_(bounding_box(solid)), options_(options), progress_(progress) {}

  /// Levels below the spacing that the options permit in thin material.
  int thin_levels() const { return options_.across > 0 ? 5 : 0; }
  /// Leaves at a spacing; empty where more than `most` cells would be divided. Adds to the report's
  /// seconds.
  std::optional<SpacedLeaves> at(double spacing, int thin_levels, std::size_t most, SampleReport& report) const;
  /// Leaves with `count` nodes, if that number can be reached; thin material as fine as the count
  /// affords.
  SpacedLeaves with_count(std::size_t count, double volume, SampleReport& report) const;

 private:
  RegionTree tree_;
  Box3 box_;
  SampleOptions options_;
  Progress progress_;
};

}  // namespace geo
