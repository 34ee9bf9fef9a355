// Reading a model for a tool: a valid solid, or one clear error.
#pragma once

#include <string>

#include "base/error.h"
#include "io/surface_file.h"
#include "surface/check.h"
#include "surface/complex.h"

namespace tool {

/// The surface in a file, checked: closed, manifold, oriented outwards, free of self-intersection.
inline geo::SurfaceFile read_solid(const std::string& path) {
  geo::SurfaceFile file = geo::read_surface(path);
  try {
    geo::require_solid(file.mesh);
  } catch (const geo::InputError& e) {
    throw geo::InputError(path + ": " + e.what());
  }
  return file;
}

/// The complex of a surface that was read; errors carry the file's name.
inline geo::Complex complex_of(const geo::SurfaceFile& file, const std::string& path) {
  try {
    return geo::Complex::from_two_sided(file.mesh);
  } catch (const geo::InputError& e) {
    throw geo::InputError(path + ": " + e.what());
  }
}

}  // namespace tool
