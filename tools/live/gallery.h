// Bodies to begin with, made by procedures: no files.
#pragma once

#include <string>
#include <vector>

#include "live/model_file.h"

namespace live {

/// The names of the bodies, as the page shows them.
std::vector<std::string> gallery_names();

/// A body as a PLY file. Throws geo::InputError for a name that is not in the gallery.
ModelFile gallery_model(const std::string& name);

}  // namespace live
