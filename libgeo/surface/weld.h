// Welds seams: vertices that a file stores several times.
#pragma once

#include "kerf/mesh.h"

namespace geo {

/// Merges vertices that coincide (exactly, or transitively up to `reach` apart, model units) and
/// each end an edge with a single triangle: exporters write a vertex for each texture coordinate or
/// normal at a seam, and STL three for each triangle. The lowest index stays; later vertices move
/// up. Triangles and corner attributes stay. Closed parts that touch stay separate. Precondition: a
/// mesh without sites. Returns the number of vertices removed.
std::size_t weld_seams(TriangleMesh& mesh, double reach = 0);

}  // namespace geo
