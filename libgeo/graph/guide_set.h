// Guides: Steiner points of the visibility graph (§ 8).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kerf/vec.h"
#include "sampling/node_grid.h"

namespace geo {

/// A point where shortest paths may bend, beside a concave edge of the surface. It has no volume,
/// and no surface vertex is bound to it.
struct Guide {
  Vec3 position;      ///< inside the material
  double radius = 0;  ///< it has edges to what it sees within this distance; its support radius in warped
                      ///< lengths. Model units. 0: retired
};

/// The guides that a step adds and retires.
struct GuideChange {
  std::vector<Guide> added;            ///< new guides
  std::vector<std::uint32_t> retired;  ///< ids of guides that lose all edges and keep their ids
};

/// The guides of a graph, numbered from 0 in the order of their addition.
class GuideSet {
 public:
  /// Number of guides, retired ones included.
  std::uint32_t size() const { return static_cast<std::uint32_t>(position_.size()); }
  /// Position of guide g.
  const Vec3& position(std::uint32_t g) const { return position_[g]; }
  /// Radius of guide g; 0 when it is retired.
  double radius(std::uint32_t g) const { return radius_[g]; }
  /// Largest radius of all guides so far.
  double largest_radius() const { return largest_; }
  /// Appends a guide.
  void add(const Guide& guide) {
    if (position_.empty()) grid_ = NodeGrid(guide.radius > 0 ? 0.5 * guide.radius : 1.0);
    position_.push_back(guide.position);
    radius_.push_back(guide.radius);
    largest_ = std::max(largest_, guide.radius);
    grid_.insert(position_, size() - 1);
  }
  /// Retires guide g; it keeps its number.
  void retire(std::uint32_t g) { radius_[g] = 0; }
  /// Is guide g retired?
  bool retired(std::uint32_t g) const { return radius_[g] == 0; }
  /// Appends the guides within `distance` of p, retired ones included, ascending.
  void within(const Vec3& p, double distance, std::vector<std::uint32_t>& out) const {
    if (!position_.empty()) grid_.within(position_, p, distance, out);
  }
  /// The grid over the positions of all guides, retired ones included.
  const NodeGrid& grid() const { return grid_; }
  /// Bytes of memory.
  std::size_t bytes() const {
    return position_.capacity() * sizeof(Vec3) + radius_.capacity() * sizeof(double) + grid_.bytes();
  }
  /// Equal positions and radii.
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
