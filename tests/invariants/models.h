// Models for the tests of invariants. They are not in the tree: Debian's libcgal-demo provides
// them.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/mesh.h"

namespace invariants {

/// "pumpkin", or a mesh from the folder KERF_MODELS, else from where the build unpacked them.
/// Throws when it is absent.
inline geo::TriangleMesh model(const std::string& name) {
  if (name == "pumpkin") return geo::make_pumpkin(8);
  const char* named = std::getenv("KERF_MODELS");
  const std::string folder = named ? named : KERF_MODEL_FOLDER, file = name + ".off";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.path().filename() == file) return geo::read_surface(entry.path().string()).mesh;
  throw geo::InputError(folder + ": has no " + file);
}

}  // namespace invariants
