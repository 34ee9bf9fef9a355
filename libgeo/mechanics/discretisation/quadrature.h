// Background quadrature of the Galerkin discretisation: four points in each cell of an octree that
// is as fine as the nodes and clipped to the material.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "kerf/body.h"
#include "sampling/octree.h"

namespace geo {

/// A cell with four points of equal weight. In a whole cell they are a tetrahedral half of the 2³
/// Gauss rule. In a cell that the surface cuts, they have the mean and the second moments of the
/// material inside, where possible. A whole cell beside finer ones appears twice, with half of its
/// volume and four points of an even 2³ lattice each: supports of the finer nodes reach into it.
struct QuadratureCell {
  Cell cell;
  bool whole = false;
  std::uint8_t half = 0;  ///< of a cell that appears twice: 1 or 2
  double volume = 0;      ///< of its material, model units³
  std::array<Vec3, 4> point;
  double unscaled_volume = 0;  ///< the estimate before all volumes were scaled
};

/// The cells of a body. Nodes alone decide the octree: a cell that holds a node of a finer spacing
/// is divided. Cracks change cells only through the nodes that they insert; which side of a crack a
/// point sees is found later.
class QuadratureCells {
 public:
  /// No cells.
  QuadratureCells() = default;
  /// The cells of a body.
  explicit QuadratureCells(const Body& body);
  /// Updates cells after nodes were inserted or moved. Returns true if they have changed.
  bool update(const Body& body);

  /// The cells in Morton order, then by `half`. Their volumes sum to that of the nodes.
  const std::vector<QuadratureCell>& cells() const { return cells_; }
  /// Divides the cells into groups of at most `max_cells`: each is a run of children of one octree
  /// cell, as many as fit. A group depends only on cells inside that octree cell. Returns the first
  /// cell of each group, and cells().size().
  std::vector<std::size_t> groups(std::size_t max_cells) const;

 private:
  Divisions divisions(const NodeSet& nodes) const;
  bool is_beside_divided(const Cell& cell) const;
  Divisions changed_cells(const Divisions& before) const;
  std::function<bool(const Region&, std::vector<QuadratureCell>&)> visitor() const;
  void scale_volumes(const NodeSet& nodes);

  Lattice lattice_{Vec3::Zero(), 1};
  int root_ = 0;  // level of the root cell
  Divisions divided_;
  std::shared_ptr<const RegionTree> skin_;
  std::vector<QuadratureCell> unscaled_;  // cells_ before volumes were scaled
  std::vector<QuadratureCell> cells_;
};

}  // namespace geo
