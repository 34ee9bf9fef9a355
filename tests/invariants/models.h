// The models that the invariants are tested on. They are never in the tree: Debian's libcgal-demo brings them.
#pragma once

#include <cstdlib>
#include <string>

#include "io/surface_file.h"
#include "surface/shapes.h"

namespace invariants {

/// "pumpkin", or a mesh from the folder KERF_MODELS, else from where the build unpacked them. Throws when it is absent.
inline geo::TriangleMesh model(const std::string& name) {
  if (name == "pumpkin") return geo::make_pumpkin(8);
  const char* folder = std::getenv("KERF_MODELS");
  return geo::read_surface(std::string(folder ? folder : KERF_MODEL_FOLDER) + "/" + name + ".off").mesh;
}

}  // namespace invariants
