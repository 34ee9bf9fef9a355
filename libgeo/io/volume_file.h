// Volumes in files: OpenVDB level sets and fog volumes, as closed surfaces.
#pragma once

#include <optional>
#include <string>

#include "surface/triangle_mesh.h"

namespace geo {

struct VolumeOptions {
  std::string grid = {};           ///< which grid, by name; empty: the only one of numbers
  std::optional<double> iso = {};  ///< the surface's level; default: 0 of a level set, 0.5 of a fog volume
  double adaptivity = 0;           ///< 0: triangles of a voxel's size everywhere; up to 1: larger where the surface is flat
};

/// The surface of a scalar grid of a `.vdb` file ("-": standard input), at values below the level for a level set, above
/// it for any other. Closed, oriented outwards, world units. Throws InputError for files that are no OpenVDB, hold no
/// grid of single- or double-precision numbers or several to choose from, or have no closed surface at the level.
TriangleMesh read_volume(const std::string& path, const VolumeOptions& options = {});

/// A new surface around a closed one, which may cross itself: that of its level set, with voxels of the given size (edges are rounded
/// by as much). `source` names the triangle that each is nearest to, and attributes are those of this one.
TriangleMesh wrapped(const TriangleMesh& solid, double voxel);

/// Writes a mesh's level set with voxels of the given size, or with `fog` a density from 0 outside to 1 in the depth;
/// for samples and tests.
void write_level_set(const std::string& path, const TriangleMesh& solid, double voxel, bool fog = false);

}  // namespace geo
