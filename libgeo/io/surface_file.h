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

/// Reads any supported format, told by content first and by extension next; polygons are triangulated as fans,
/// or by ears where they are not convex; seams are welded (weld_seams) unless there are sites. What the file has of attributes and sources comes with it. Throws InputError (with line or row) on anything malformed, NaN or infinite,
/// indices out of range, sizes that the file cannot hold, trailing garbage.
SurfaceFile read_surface(const std::string& path);
SurfaceFile parse_surface(const std::string& bytes, const std::string& name);

/// Binary little-endian PLY with `patch`, `site`, `source`, the attributes and, where given, the fronts' contacts as
/// elements of their own; docs/formats.md says how. Numbers are written in the smallest type that holds them exactly.
void write_ply(std::ostream& out, const TriangleMesh& mesh, const std::vector<FrontState>& fronts = {},
               const std::string& comment = {});
/// Wavefront OBJ: patches as `g patch_N`, groups as `usemtl`. OBJ has one colour a vertex, without alpha: that of the
/// skin there.
void write_obj(std::ostream& out, const TriangleMesh& mesh);

}  // namespace geo
