// Keys of a scene by their dotted names, for overrides, and checks of keyframes.
#pragma once

#include <string>
#include <vector>

#include "io/toml_table.h"
#include "kerf/scene.h"

namespace geo {

/// Sets the key with a dotted name to a value in TOML; numbers are indices of lists. Throws
/// InputError.
void override_key(toml::table& root, const std::string& key, const std::string& value);

/// The first fault of keyframes; empty where there is none.
std::string unfit(const std::vector<Motion::Key>& keys);

}  // namespace geo
