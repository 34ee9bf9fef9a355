// Scenes in files: TOML. docs/formats.md lists every key.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "simulation/scene.h"

namespace geo {

/// Reads a scene; `overrides` are dotted keys and TOML values ("material.young", "2e5"). Throws InputError with file,
/// line and column: syntax, unknown keys, wrong types, impossible values.
Scene read_scene(const std::string& path, const std::vector<std::pair<std::string, std::string>>& overrides = {});
Scene parse_scene(const std::string& text, const std::string& name, const std::vector<std::pair<std::string, std::string>>& overrides = {});

}  // namespace geo
