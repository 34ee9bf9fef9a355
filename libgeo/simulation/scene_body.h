// The body of a scene: all placed models as components of one Body, and their materials.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/body.h"
#include "kerf/material.h"
#include "kerf/progress.h"
#include "kerf/simulation.h"

namespace geo {

/// Samples each model and builds the body. `body_index` receives the body of the scene that each
/// node belongs to. Throws InputError as sampling does.
Body build_scene_body(const Scene& scene, const PlacedModels& models, std::vector<std::uint32_t>& body_index,
                      const Progress& progress = {});

/// Materials of the nodes, by the body of the scene that each belongs to.
Materials materials_of(const Scene& scene, const std::vector<std::uint32_t>& body_index);

}  // namespace geo
