// Where a blade's edge is in the material: several runs where it meets a body in several places (§ 5.1).
#pragma once

#include <vector>

#include "kerf/scene.h"
#include "mechanics/discretisation/point_map.h"
#include "simulation/edge_front.h"

namespace geo {

/// The parts of the edge that are within the support of nodes, each mapped back as one. Between the blade's own points
/// others are put in where the mapping bends the edge by more than a tenth of a spacing, and where a run ends; points
/// that it brings closer than a twentieth are left out. A run ends where no node is near, and where the edge goes on in
/// material that is apart from that before.
std::vector<std::vector<EdgePoint>> edge_runs(const PointMap& map, const Body& body, const Blade& blade,
                                              const Pose& pose);

/// All points of a closed edge, mapped one by one.
std::vector<EdgePoint> closed_run(const PointMap& map, const Body& body, const Blade& blade, const Pose& pose);

/// The fronts that go with `runs`, found among `before`: those that a run goes on from, joined where it goes on from
/// several, parted where several go on from one. Runs that go on from none have no points yet.
std::vector<EdgeFront> fronts_of(const std::vector<std::vector<EdgePoint>>& runs, const std::vector<EdgeFront>& before);

}  // namespace geo
