// A blow between two frames: the piece that is hit breaks into cells, small near the blow.
#pragma once

#include <kerf/simulation.h>
#include "live/surface_view.h"

namespace live {

/// A run that goes on with the piece in parts, which fly from the point. Its surface has moved
/// nowhere. Cracks that grow by stress end.
/// \param hit  a point of the run's surface, and its place in the world
/// \param cells  of the box around the piece: the piece breaks into about as many parts, or fewer
/// \throws BadMessage where a blade is in the body, or where the piece does not break
geo::RunStart broken_body(const geo::Simulation& run, const PickedPoint& hit, const geo::Vec3& place, int cells);

}  // namespace live
