// Bodies that touch are moved apart by a tiny gap before a run; bodies that overlap are refused.
#pragma once

#include "kerf/simulation.h"

namespace geo {

/// Moves the vertices of triangles of different bodies that touch, or nearly do, into their own
/// bodies, so that a gap remains between them; all other vertices stay, to the bit. Contact begins
/// with surfaces that are apart, and keeps this distance between opened sheets, too
/// (ContactOptions::gap). Fills models.touching. Throws InputError, which names two bodies, where
/// they overlap deeper than the gap or cannot be moved apart.
void part_touching_bodies(const Scene& scene, PlacedModels& models);

}  // namespace geo
