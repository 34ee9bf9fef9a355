// Surfaces in files: PLY, OBJ, STL and OFF; OpenVDB volumes as closed surfaces.
#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "kerf/crack.h"
#include "kerf/mesh.h"

namespace geo {

/// A surface, with the fronts that were cutting it when it was written. kerf-crack continues them.
struct SurfaceFile {
  TriangleMesh mesh;
  std::vector<FrontState> fronts;
};

/// Reads a surface from a file, or from standard input where `path` is "-". The format is
/// recognised by content; unknown content is read as STL. Polygons are triangulated as fans, by ear
/// clipping where they are not convex. Coincident vertices of seams are merged unless the mesh has
/// sites. Throws InputError, with the line or entry: malformed data, numbers that are not finite,
/// indices out of range, sizes larger than the file, trailing bytes.
SurfaceFile read_surface(const std::string& path);
/// The same from bytes in memory; `name` stands for the file in messages.
SurfaceFile parse_surface(const std::string& bytes, const std::string& name);

/// Writes binary little-endian PLY with patch, site, source, attributes, and the contacts of
/// `fronts` as further elements (docs/formats.md). Numbers have the smallest type that holds them
/// exactly.
void write_ply(std::ostream& out, const TriangleMesh& mesh, const std::vector<FrontState>& fronts = {},
               const std::string& comment = {});
/// Writes Wavefront OBJ: patches as `g patch_N`, groups as `usemtl`. OBJ has one colour a vertex,
/// without alpha: the colour of the skin is written.
void write_obj(std::ostream& out, const TriangleMesh& mesh);

// ---- Volumes.

struct VolumeOptions {
  std::string grid = {};           ///< name of the grid; empty: the only scalar grid of the file
  std::optional<double> iso = {};  ///< level of the surface; default: 0 of a level set, 0.5 of a fog volume
  double adaptivity = 0;           ///< 0: triangles of voxel size; up to 1: larger ones where the surface is flat
};

/// The iso-surface of a scalar grid in an OpenVDB file ("-": standard input). Inside are values
/// below the level for a level set, above it for any other grid. Closed, oriented outwards, world
/// units. Throws InputError where the file is no OpenVDB file, has no floating-point grid, several
/// without a name given, or no closed surface at the level.
TriangleMesh read_volume(const std::string& path, const VolumeOptions& options = {});

/// A new surface around a closed one, which may intersect itself: the zero level of its distance
/// field, with voxels of edge `voxel`, which also rounds edges by that length. `source` is the
/// nearest triangle of `solid`, which also gives the attributes.
TriangleMesh wrapped(const TriangleMesh& solid, double voxel);

/// Writes a mesh as a level set with voxels of edge `voxel`; with `fog` as a density from 0 outside
/// to 1 inside. For samples and tests. Throws OutputError.
void write_level_set(const std::string& path, const TriangleMesh& solid, double voxel, bool fog = false);

}  // namespace geo
