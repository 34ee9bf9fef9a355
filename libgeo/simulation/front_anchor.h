// Keeps the way of a blade's edge through the material free of jumps at the front that the edge has
// left (§ 5.1).
#pragma once

#include <span>
#include <vector>

#include "kerf/body.h"
#include "simulation/blade_way.h"
#include "simulation/edge_front.h"

namespace geo {

/// A cut takes neighbours from nodes, so the map to the material changes by parts of a spacing
/// beside the front, although neither nodes nor blade have moved. The places of an edge are
/// corrected by this change at its front, along the normal of the sheet. The correction fades out
/// two spacings from the front.
class FrontAnchor {
 public:
  /// For a front that an edge has left. `start`: the map at the time when it got there.
  FrontAnchor(const Complex& surface, const MapAt& start, const Blade& blade, const EdgeFront& edge);
  /// The place in the material of an edge parameter, corrected. `place`: by the map at a later
  /// time; `spacing`: of the nodes there. Model units.
  Vec3 corrected(double at, const Vec3& place, double spacing) const;

 private:
  std::vector<double> at_;            // of the points of the front, ascending
  std::vector<Vec3> place_, change_;  // per point: its place; what the map has changed by
};

}  // namespace geo
