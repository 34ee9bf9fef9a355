// Surfaces in files: PLY (ASCII and binary, both orders), OBJ, STL (ASCII and binary), OFF.
#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "kerf/crack.h"
#include "kerf/mesh.h"

namespace geo {

/// A surface with the fronts that were still cutting it when it was written ("- " continued by kerf-crack).
struct SurfaceFile {
  TriangleMesh mesh;
  std::vector<FrontState> fronts;
};

/// Reads any supported format, told by content first and by extension next; polygons are triangulated as fans,
/// or by ears where they are not convex; seams are welded (weld_seams) unless there are sites. What the file has of
/// attributes and sources comes with it. Throws InputError (with line or row) on anything malformed, NaN or infinite,
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

// ---- Volumes in files: OpenVDB level sets and fog volumes, as closed surfaces.

struct VolumeOptions {
  std::string grid = {};           ///< which grid, by name; empty: the only one of numbers
  std::optional<double> iso = {};  ///< the surface's level; default: 0 of a level set, 0.5 of a fog volume
  double adaptivity = 0;  ///< 0: triangles of a voxel's size everywhere; up to 1: larger where the surface is flat
};

/// The surface of a scalar grid of a `.vdb` file ("-": standard input), at values below the level for a level set,
/// above it for any other. Closed, oriented outwards, world units. Throws InputError for files that are no OpenVDB,
/// hold no grid of single- or double-precision numbers or several to choose from, or have no closed surface at the
/// level.
TriangleMesh read_volume(const std::string& path, const VolumeOptions& options = {});

/// A new surface around a closed one, which may cross itself: that of its level set, with voxels of the given size
/// (edges are rounded by as much). `source` names the triangle that each is nearest to, and attributes are those of
/// this one.
TriangleMesh wrapped(const TriangleMesh& solid, double voxel);

/// Writes a mesh's level set with voxels of the given size, or with `fog` a density from 0 outside to 1 in the depth;
/// for samples and tests.
void write_level_set(const std::string& path, const TriangleMesh& solid, double voxel, bool fog = false);

}  // namespace geo
