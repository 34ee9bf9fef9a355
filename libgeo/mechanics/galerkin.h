// The element-free Galerkin discretisation: quadrature points, each with the nodes it sees (visibility: Belytschko, Lu and
// Gu 1994), in blocks that follow cuts.
#pragma once

#include "mechanics/material_points.h"
#include "mechanics/quadrature.h"

namespace geo {

class Galerkin {
 public:
  Galerkin() = default;
  /// From scratch.
  Galerkin(const Body& body, MaterialPoints& points);
  /// After a split: points are looked at again where a face or a node within their support has changed. The result is that
  /// of a build from scratch, bit for bit. `old_position`: of moved nodes, before they moved. Appends to `kept`, for each
  /// point there is now, the number of the same point before, or ~0u; nothing where all are the same.
  void update(const Body& body, const BodyDelta& delta, std::span<const Vec3> old_position, MaterialPoints& points, std::vector<std::uint32_t>& kept);

 private:
  void build(const Body& body, MaterialPoints& points) const;
  QuadratureCells cells_;
  std::vector<std::size_t> groups_;
};

}  // namespace geo
