// Material files of Wavefront (.mtl), which OBJ files name.
#pragma once

#include <string>
#include <vector>

#include "kerf/mesh.h"

namespace geo {

/// Gives a mesh the library of its groups' materials, from the .mtl files that `files` names and
/// the images that these name. All are looked for in the folder of `name` and below.
///
/// Nothing is refused: `notes` receives a line for a file that is not there, and one for what the
/// library cannot say. A mesh without groups, or with a library, stays as it is.
void add_mtl_library(TriangleMesh& mesh, const std::vector<std::string>& files, const std::string& name,
                     std::vector<std::string>& notes);

}  // namespace geo
