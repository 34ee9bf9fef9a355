// Prestretch at the start of a run: as a scene gives it, and as the bodies need to bear their load.
#pragma once

#include "kerf/progress.h"
#include "kerf/simulation.h"

namespace geo {

/// Gives each material point the prestretch of its body: state.motion.prestretch. It stays empty
/// where no body has any.
void begin_prestretch(const Scene& scene, const PlacedModels& models, const Body& body, RunState& state);

/// Changes prestretch, displacements and velocities so that the bodies rest under gravity, loads,
/// supports, ground and obstacles as they are at time 0, in their own shape: what each round of
/// equilibrium strains is added to the prestretch (Gee, Förster and Wall 2010). Throws
/// GeometryError where they do not come to rest.
void bear_load(const Scene& scene, RunStart& run, const Progress& progress);

}  // namespace geo
