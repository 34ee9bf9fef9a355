// The element-free Galerkin discretisation (Belytschko, Lu and Gu 1994): quadrature points, each with the nodes it
// sees, round the fronts of cracks too, in blocks that follow cuts.
#pragma once

#include "mechanics/discretisation/material_points.h"
#include "mechanics/discretisation/quadrature.h"

namespace geo {

class Galerkin {
 public:
  Galerkin() = default;
  /// From scratch.
  Galerkin(const Body& body, MaterialPoints& points);
  /// Takes down what a split has changed, for settle(). `old_position`: of moved nodes, before they moved.
  void note(const Body& body, const BodyDelta& delta, std::span<const Vec3> old_position);
  /// Whether a split has been noted since.
  bool is_due() const { return !faces_.empty() || !supports_.empty(); }
  /// After splits: new rows for points of which the cell, a node within the support or the sight of one has changed.
  /// The result is that of a build from scratch, bit for bit.
  PointChanges settle(const Body& body, MaterialPoints& points);

 private:
  std::span<const QuadratureCell> group(std::size_t b) const {
    return {&cells_.cells()[groups_[b]], groups_[b + 1] - groups_[b]};
  }
  QuadratureCells cells_;
  std::vector<std::size_t> groups_;
  std::vector<std::array<Vec3, 3>> faces_;         // changed since the last settle()
  std::vector<std::pair<Vec3, double>> supports_;  // of nodes that came, went, moved or changed their radius since
};

}  // namespace geo
