// A blow between two frames: the piece that is hit breaks into cells, small near the blow.
#pragma once

#include "kerf/simulation.h"

namespace geo {

/// A run that goes on with the piece in parts, which fly from the point. Its surface has moved
/// nowhere. Cracks that grow by stress end. The piece is that of the surface's point nearest to the
/// blow. Throws InputError where a blade is in the body, GeometryError where the piece does not
/// break.
RunStart broken_by(const Simulation& run, const Blow& blow);

}  // namespace geo
