// The sides that bound each piece, as lists: meshes of many pieces at the cost of their sides.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/pieces.h"

namespace geo {

/// The sides of each piece, ascending.
std::vector<std::vector<Side>> sides_by_piece(const Pieces& pieces);

/// The mesh of these sides, as piece_mesh(). `index`: scratch memory with ~0u for each vertex of
/// S_A, left like that.
TriangleMesh mesh_of_sides(const Complex& complex, std::span<const Side> sides, std::vector<std::uint32_t>& index,
                           std::vector<SurfaceVertexId>& vertex_of);

}  // namespace geo
