// Scenes in files: TOML. docs/formats.md lists every key.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "kerf/scene.h"

namespace geo {

/// Keys and TOML values that replace those of a file: "material.young", "2e5". A list's rows are named by number:
/// "blade.0.thickness", "body.fixed.1.5".
using SceneOverrides = std::vector<std::pair<std::string, std::string>>;

/// Reads a scene, with the fronts and motions that it names; the mesh of each body becomes a path from where one
/// stands. Throws InputError with file, line and column: syntax, unknown keys, wrong types, impossible values.
Scene read_scene(const std::string& path, const SceneOverrides& overrides = {});
/// The same from memory. Files that it names are sought in `folder`; meshes are left as they are written.
Scene parse_scene(const std::string& text, const std::string& name, const SceneOverrides& overrides = {},
                  const std::string& folder = "");

/// A motion from a table of numbers: time, position, axis, degrees a line, with commas or blanks between them; a first
/// line of words and what follows # are passed over. Throws InputError with the line.
std::vector<Motion::Key> parse_motion(const std::string& text, const std::string& name);

}  // namespace geo
