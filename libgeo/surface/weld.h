// Welds seams of attributes: edges along which a file stores vertices several times.
#pragma once

#include "kerf/mesh.h"

namespace geo {

/// Merges vertices at open edges (edges of one triangle) that coincide exactly or, with `reach`, in
/// chains of steps up to `reach`, model units. Exporters write a vertex for each texture coordinate
/// or normal at a seam, and STL three for each triangle. Closed parts that touch stay separate.
///
/// The vertex with the lowest index stays, with its position. Vertices behind a removed one get
/// lower indices, in the same order. Triangles keep their number, order and corner attributes; one
/// whose corners merge becomes degenerate. Returns the number of vertices removed. Precondition:
/// !mesh.two_sided(), since the two sides of a crack coincide and must not be merged.
std::size_t weld_seams(TriangleMesh& mesh, double reach = 0);

}  // namespace geo
