// A scene for a model that comes without one.
#pragma once

#include <string>

#include <kerf/files.h>
#include "sim/setup.h"

namespace live {

/// True where a file is a scene by its name: .toml or .json.
bool is_scene(const std::string& path);

/// A soft body of `nodes` nodes that stands on the ground, in gravity, with self-contact. Lengths
/// and stiffness are scaled to the model's size, so that it sags little, whatever its units. `up`:
/// the vertical axis, 'y' or 'z'.
sim::Setup bare_model(const std::string& path, int nodes, char up, const geo::SceneOverrides& overrides);

}  // namespace live
