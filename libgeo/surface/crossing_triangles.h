// Triangles of a mesh that cross each other.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "kerf/mesh.h"

namespace geo {

/// Pairs (i > j) of triangles that cross, ascending, as faces_cross() tests them. Triangles that
/// have a vertex twice are left out.
std::vector<std::pair<std::uint32_t, std::uint32_t>> crossing_triangles(const TriangleMesh& mesh);

}  // namespace geo
