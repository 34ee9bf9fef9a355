// Surfaces in files: PLY (ASCII and binary, both orders), OBJ, STL (ASCII and binary), OFF.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "crack/advance.h"
#include "surface/triangle_mesh.h"

namespace geo {

/// A surface with the fronts that were still cutting it when it was written ("- " continued by kerf-crack).
struct SurfaceFile {
  TriangleMesh mesh;
  std::vector<FrontState> fronts;
};

/// Reads any supported format, told by content first and by extension next; polygons are triangulated as fans, STL
/// corners are welded by exact position. Throws InputError (with line or row) on anything malformed, NaN or infinite,
/// indices out of range, sizes that the file cannot hold, trailing garbage.
SurfaceFile read_surface(const std::string& path);
SurfaceFile parse_surface(const std::string& bytes, const std::string& name);

/// Binary little-endian PLY with `patch`, `site` and, where given, the fronts' contacts as elements of their own.
void write_ply(std::ostream& out, const TriangleMesh& mesh, const std::vector<FrontState>& fronts = {},
               const std::string& comment = {});
/// Wavefront OBJ, patches as groups.
void write_obj(std::ostream& out, const TriangleMesh& mesh);

}  // namespace geo
