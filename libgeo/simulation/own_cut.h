// The cut that a blade has made already: an edge that moves in it is in air, and cuts nothing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/complex.h"
#include "kerf/simulation.h"

namespace geo {

/// The distance of a point from the nearest living face of the given cracks (ascending numbers);
/// infinity where none is within `reach`. Lengths in model units.
double distance_from_cracks(const Complex& surface, std::span<const std::int32_t> cracks, const Vec3& point,
                            double reach);

/// The distance of a point from the polyline of a front, contacts included; model units.
double distance_from_front(const FrontState& front, const Vec3& point);

/// Whether a point of the front is on a vertex of K: it lies in the material and can go on.
bool has_contact(const FrontState& front);

/// The sheets behind all fronts of one blade. The walls of a cut lie on each other in the material,
/// so a blade that comes back maps to the sheet, but for the accuracy of the map. A strip there
/// would leave crumbs beside the sheet. Refers to its arguments.
class OwnCut {
 public:
  /// `fronts`: of the blade, those that have left the material included.
  OwnCut(const Complex& surface, std::span<const EdgeFront> fronts);
  /// Whether there is no sheet.
  bool empty() const { return cracks_.empty(); }
  /// Whether a place is in the cut: nearer to its sheets than a quarter of `spacing`, and than half
  /// of the distance from the fronts that can go on. Ahead of these the material is whole.
  bool contains(const Vec3& place, double spacing) const;
  /// Whether a front that can go on has this edge parameter. It holds its points in the cut by
  /// itself (edge_retreat.h).
  bool can_go_on(double at) const;

 private:
  const Complex& surface_;
  std::span<const EdgeFront> fronts_;
  std::vector<std::int32_t> cracks_;  // numbers, ascending
};

}  // namespace geo
