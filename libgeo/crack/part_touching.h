// Parts of a closed surface that touch in vertices and edges are moved apart, so that the surface
// is a valid solid.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kerf/mesh.h"

namespace geo::crack {

/// A closed oriented surface whose edges join pairs of triangles, also where more of them have the
/// same two vertices.
struct PairedSurface {
  TriangleMesh mesh;  ///< `site` numbers the places: vertices at one place have the same number
  /// Per triangle: the triangle across the edge from corner k to the next one.
  std::vector<std::array<std::uint32_t, 3>> beside;
};

/// Divides edges with more than two triangles, then moves all vertices but one at each shared place
/// into the material, by at most 2⁻¹² of their shortest edge. All other vertices stay. The guard is
/// the exact test for crossing triangles: motions that make triangles cross are shortened. Throws
/// GeometryError where they still cross after 64 rounds.
void part_touching(PairedSurface& surface);

}  // namespace geo::crack
