// Volumes in files: OpenVDB level sets and fog volumes, as closed surfaces.
#pragma once

#include <string>

#include "surface/triangle_mesh.h"

namespace geo {

/// The surface of the first scalar grid of a `.vdb` file: the zero level of a level set, the half-density level of a fog
/// volume (values above are inside). Closed, oriented outwards, world units. Throws InputError for files that are no
/// OpenVDB, without a float grid, or without a closed surface in it.
TriangleMesh read_volume(const std::string& path);

/// Writes a mesh's level set with voxels of the given size; for samples and tests.
void write_level_set(const std::string& path, const TriangleMesh& solid, double voxel);

}  // namespace geo
