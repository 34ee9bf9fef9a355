// Scenes of samples/scenes, and the models that samples/scenes/run makes for them.
#pragma once

#include <string>
#include <vector>

#include "kerf/files.h"
#include "kerf/mesh.h"

namespace bench {

/// The scene `name` of samples/scenes with other values for some keys.
geo::Scene sample_scene(const std::string& name, const geo::SceneOverrides& overrides = {});

/// The models of the scene `name`, one for each body. `fineness`: frequency or resolution of their
/// generator; 0: that of samples/scenes/run. Throws std::invalid_argument for a scene whose models
/// are not known.
std::vector<geo::TriangleMesh> sample_models(const std::string& name, int fineness = 0);

}  // namespace bench
