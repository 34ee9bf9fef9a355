// The element-free Galerkin discretisation (Belytschko, Lu and Gu 1994): quadrature points with the
// nodes that they see, in blocks that are updated incrementally after cuts.
#pragma once

#include <functional>

#include "mechanics/discretisation/material_points.h"
#include "mechanics/discretisation/nearby_occluders.h"
#include "mechanics/discretisation/quadrature.h"

namespace geo {

/// Builds the material points of a body and keeps them up to date.
class Galerkin {
 public:
  /// Without a body.
  Galerkin() = default;
  /// Builds `points` for a body. `component`: per node, of the visibility graph.
  Galerkin(const Body& body, std::span<const std::uint32_t> component, MaterialPoints& points);
  /// Records what a split has changed, for rebuild_changed(). `old_position`: of moved nodes,
  /// before they moved.
  void mark_changed(const Body& body, const BodyDelta& delta, std::span<const Vec3> old_position);
  /// True if changes have been marked since the last rebuild.
  bool has_changes() const { return !faces_.empty() || !supports_.empty(); }
  /// Recomputes points whose cell, support or lines of sight the marked changes touch. The result
  /// equals that of a build from scratch, bit for bit. `component`: per node, after the changes.
  /// `wants_values`: whether PointChanges::valued is to have the point at a position; called by
  /// several threads.
  PointChanges rebuild_changed(const Body& body, std::span<const std::uint32_t> component, MaterialPoints& points,
                               const std::function<bool(const Vec3&)>& wants_values);

 private:
  std::span<const QuadratureCell> cells_of(std::size_t block) const {
    return {&cells_.cells()[block_begin_[block]], block_begin_[block + 1] - block_begin_[block]};
  }

  QuadratureCells cells_;
  std::vector<std::size_t> block_begin_;           // per block its first cell; one more at the end
  std::vector<std::array<Vec3, 3>> faces_;         // added or removed since the last rebuild
  std::vector<std::pair<Vec3, double>> supports_;  // balls of nodes that were added, moved or resized since
  std::vector<std::uint32_t> nodes_;               // these nodes
  NearbyOccluders near_;                           // near the last changes
};

}  // namespace geo
