// A scene for a model that comes without one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <kerf/files.h>
#include "live/model_file.h"
#include "sim/setup.h"

namespace live {

/// True where a file is a scene by its name: .toml or .json.
bool is_scene(const std::string& path);

/// The vertical axis that the format of a file has: 'y' of glTF; 0 where it does not say.
char up_axis(const std::string& name);

/// A setup of a model, and sentences about what of its file is left out.
struct BareModel {
  sim::Setup setup;
  std::vector<std::string> notes;
};

/// A soft body of `nodes` nodes that stands on the ground, in gravity, with self-contact. Lengths
/// and stiffness are scaled to the model's size, so that it sags little, whatever its units. `up`:
/// the vertical axis, 'y' or 'z'. `path` names the file that the bytes are of. `beside` has the
/// files that came with it; nothing: those that it names are in its folder. Throws geo::InputError.
BareModel bare_model(const std::string& path, const std::string& bytes, int nodes, char up,
                     const geo::SceneOverrides& overrides, const std::optional<std::vector<BesideFile>>& beside = {});

}  // namespace live
