// Formats that assimp reads: io/surface_assimp.cpp, or io/without_assimp.cpp in a build without it.
#pragma once

#include <string>

#include "io/surface_other.h"
#include "kerf/files.h"

namespace geo {

/// Whether assimp has a reader for an ending, without the dot; false where the library is missing.
bool assimp_reads(const std::string& ending);

/// parse_other() for a format whose reader is assimp's. Throws InputError, which says what to do
/// where the library is missing.
SurfaceFile parse_by_assimp(const std::string& bytes, const std::string& name, const OtherFormat& format);

}  // namespace geo
