// Where strain energy is summed: four points in each cell of an octree as fine as the nodes, clipped to the material.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "kerf/body.h"
#include "sampling/octree.h"

namespace geo {

/// A cell with its points, which share its material evenly. Where the surface cuts the cell they have the mean and the
/// second moments of what is inside; in a whole cell that is the tetrahedral half of Gauss' 2³ rule.
struct QuadratureCell {
  Cell cell;
  bool whole = false;
  double volume = 0;  ///< of its material, model units³
  std::array<Vec3, 4> point;
  double measured = 0;  ///< the volume that was found, before all were scaled
};

/// The octree is told by the nodes alone: a cell that holds a node of a finer spacing is divided. Cracks change nothing
/// but through nodes that they insert; points find out themselves which side of a crack they are on.
class QuadratureCells {
 public:
  QuadratureCells() = default;
  explicit QuadratureCells(const Body& body);
  /// After nodes were inserted or moved. True when cells have changed.
  bool follow(const Body& body);

  /// In Morton order; their volumes sum to that of the nodes.
  const std::vector<QuadratureCell>& cells() const { return cells_; }
  /// Groups of `most` cells or fewer, each of as many children of one cell of the octree, one after another, as there
  /// is room for: the first of each, and one past the last. What a group holds depends on nothing outside of that cell.
  std::vector<std::size_t> groups(std::size_t most) const;

 private:
  Divisions divisions(const NodeSet& nodes) const;
  std::function<bool(const Region&, std::vector<QuadratureCell>&)> visit() const;
  void share_volume(const NodeSet& nodes);

  Lattice lattice_{Vec3::Zero(), 1};
  int root_ = 0;
  Divisions divided_;
  std::shared_ptr<const RegionTree> skin_;
  std::vector<QuadratureCell> placed_;  // with the volumes that were found in them
  std::vector<QuadratureCell> cells_;
};

}  // namespace geo
