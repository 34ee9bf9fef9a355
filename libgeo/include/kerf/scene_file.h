// Scenes in TOML files. docs/formats.md lists every key.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "kerf/scene.h"

namespace geo {

/// Keys and TOML values that replace those of a file: "material.young", "2e5". Entries of lists
/// have numbers from 0: "blade.0.thickness", "body.fixed.1.5".
using SceneOverrides = std::vector<std::pair<std::string, std::string>>;

/// Reads a scene ("-": standard input), with the fronts, obstacles and motions that it names. The
/// mesh of each body becomes a path relative to the current folder. Throws InputError, with file,
/// line and column, for syntax errors, unknown keys, wrong types and impossible values.
Scene read_scene(const std::string& path, const SceneOverrides& overrides = {});
/// The same from text in memory; `name` stands for the file in messages. Files that the scene names
/// are relative to `folder`; mesh paths stay as they are written.
Scene parse_scene(const std::string& text, const std::string& name, const SceneOverrides& overrides = {},
                  const std::string& folder = "");

/// Reads keyframes from a table: time, position, axis and degrees on each line, with commas or
/// blanks between the numbers. A first line of words is ignored, as is what follows #. Throws
/// InputError with the line.
std::vector<Motion::Key> parse_motion(const std::string& text, const std::string& name);

}  // namespace geo
