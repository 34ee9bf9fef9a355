// What scene files and the command line share: keys by their dotted names, and what keyframes must be.
#pragma once

#include <string>
#include <vector>

#include "io/toml_table.h"
#include "kerf/scene.h"

namespace geo {

/// Puts `value`, as TOML, where the dotted key says; numbers name rows of lists. Throws InputError.
void override_key(toml::table& root, const std::string& key, const std::string& value);

/// What is wrong with keyframes; empty when nothing is.
std::string unfit(const std::vector<Motion::Key>& keys);

}  // namespace geo
