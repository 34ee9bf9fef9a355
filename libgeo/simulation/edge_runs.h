// The parts of a blade's edge that are inside the material: its runs, one for each place where it
// meets a body (§ 5.1).
#pragma once

#include <vector>

#include "kerf/scene.h"
#include "mechanics/discretisation/inverse_deformation.h"
#include "simulation/edge_front.h"

namespace geo {

/// The runs of an open edge within the support of nodes, mapped into the material. Between the
/// blade's own points, samples are inserted where the map bends the edge by more than a fiftieth of
/// a node spacing, where they are more than two spacings apart, and at the ends of a run. Points
/// closer than a twentieth of a spacing, in the material, replace the one before. A run ends where
/// no node is near, and where the edge continues in material that is disconnected from it. It also
/// ends where the edge is in a cut that exists, unless it crosses that cut within a spacing.
/// `fronts`: of the blade, those that its edge has left included. Where the map is not one to one,
/// they choose the place: that near to theirs.
std::vector<std::vector<EdgePoint>> edge_runs(const InverseDeformation& map, const Body& body, const Blade& blade,
                                              const Pose& pose, std::span<const EdgeFront> fronts);

/// The points of a closed edge, each mapped into the material.
std::vector<EdgePoint> closed_run(const InverseDeformation& map, const Body& body, const Blade& blade, const Pose& pose,
                                  std::span<const EdgeFront> fronts);

/// First a front for each run: the one among `before` that the run continues. Fronts are joined
/// where a run continues several, and split where several runs continue one. A run that continues
/// none gets a front without points. Then the fronts that no run continues, as left: the edge
/// continues them when it comes back through their cut. One a crack remains of those that have left
/// the material.
std::vector<EdgeFront> fronts_of(const std::vector<std::vector<EdgePoint>>& runs, const std::vector<EdgeFront>& before,
                                 const Complex& surface);

}  // namespace geo
