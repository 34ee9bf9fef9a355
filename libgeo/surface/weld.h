// Seams of a surface that its file has apart.
#pragma once

#include "kerf/mesh.h"

namespace geo {

/// Makes one vertex of those that are at one place (exactly, or up to `reach` apart, one after
/// another) and each end an edge with a single triangle: exporters write a vertex for each texture
/// coordinate or normal there, and STL three for each triangle. The lowest row stays, rows behind
/// those that go move up; triangles and all that belongs to their corners stay. Nothing else is
/// changed: parts that are closed and touch stay apart. The mesh has no sites. Returns how many
/// vertices went.
std::size_t weld_seams(TriangleMesh& mesh, double reach = 0);

}  // namespace geo
