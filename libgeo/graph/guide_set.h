// Guides: points of the visibility graph that are no nodes (§ 8).
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "kerf/vec.h"
#include "sampling/node_grid.h"

namespace geo {

/// A point that paths may bend at, beside an edge where the material's surface is concave. It has no volume and nothing
/// is bound to it.
struct Guide {
  Vec3 position;
  double radius = 0;  ///< it has edges to what it sees within this distance; its support radius in warped lengths.
                      ///< Model units. 0: retired, sees nothing
};

/// What a step does to the guides of a graph.
struct GuideChange {
  std::vector<Guide> added;
  std::vector<std::uint32_t> retired;  ///< ids; they lose all edges, and keep their ids
};

class GuideSet {
 public:
  std::uint32_t size() const { return static_cast<std::uint32_t>(position_.size()); }
  const Vec3& position(std::uint32_t g) const { return position_[g]; }
  double radius(std::uint32_t g) const { return radius_[g]; }
  double largest_radius() const { return largest_; }
  void add(const Guide& guide) {
    if (position_.empty()) grid_ = NodeGrid(guide.radius > 0 ? 0.5 * guide.radius : 1.0);
    position_.push_back(guide.position), radius_.push_back(guide.radius);
    largest_ = std::max(largest_, guide.radius);
    grid_.insert(position_, size() - 1);
  }
  /// From now on it sees nothing; it keeps its place.
  void retire(std::uint32_t g) { radius_[g] = 0; }
  bool retired(std::uint32_t g) const { return radius_[g] == 0; }
  /// Appends the guides, retired ones too, within `distance` of p, ascending.
  void within(const Vec3& p, double distance, std::vector<std::uint32_t>& out) const {
    if (!position_.empty()) grid_.within(position_, p, distance, out);
  }
  /// Over the positions of all, retired ones too.
  const NodeGrid& grid() const { return grid_; }
  /// What they take in memory.
  std::size_t bytes() const {
    return position_.capacity() * sizeof(Vec3) + radius_.capacity() * sizeof(double) + grid_.bytes();
  }
  friend bool operator==(const GuideSet& a, const GuideSet& b) {
    return a.position_ == b.position_ && a.radius_ == b.radius_;
  }

 private:
  std::vector<Vec3> position_;
  std::vector<double> radius_;
  double largest_ = 0;
  NodeGrid grid_;
};

}  // namespace geo
