// Leaves at a spacing, and the spacing that gives as many nodes as asked for.
#pragma once

#include "sampling/leaves.h"

namespace geo {

/// Which leaves get a node: those with enough material, ties decided at random.
struct Keep {
  float share = float(least_share);
  std::uint64_t ticket = 0;
  static std::uint64_t ticket_of(const Leaf& leaf);
  bool operator()(const Leaf& leaf) const {
    return leaf.node && (leaf.share != share ? leaf.share > share : ticket_of(leaf) >= ticket);
  }
};

struct Found {
  LeafLists lists;
  Lattice lattice;
  ThinPlaces thin;
  Keep keep;
};

/// Leaves over one solid at any spacing.
class LeafFinder {
 public:
  LeafFinder(const TriangleMesh& solid, const SampleOptions& options, const Progress& progress)
      : tree_(solid), box_(bounding_box(solid)), options_(options), progress_(progress) {}

  /// How many levels below the spacing the options let thin material have.
  int thin_levels() const { return options_.across > 0 ? 5 : 0; }
  /// At a spacing; nothing where more than `most` cells would have to be divided. Adds to the report's seconds.
  std::optional<Found> at(double spacing, int thin_levels, std::size_t most, SampleReport& report) const;
  /// With `count` nodes, if that can be reached; thin material as fine as the count affords.
  Found with_count(std::size_t count, double volume, SampleReport& report) const;

 private:
  RegionTree tree_;
  Box3 box_;
  SampleOptions options_;
  Progress progress_;
};

}  // namespace geo
