// The time of other libraries for the same sheets.
#pragma once

#include <functional>

#include "kerf/mesh.h"

namespace bench {

/// CPU seconds of CGAL's corefine of a solid with each of these open sheets, each from a fresh copy
/// of the solid (copying is not counted); the sum over the sheets, least of several runs.
double corefine_seconds(const geo::TriangleMesh& solid, const std::vector<geo::TriangleMesh>& sheets, int runs);

/// A lower bound for any exact method on a whole sheet: candidate pairs from an existing tree,
/// exact tests, intersection points, and a constrained triangulation of every triangle that is cut,
/// of solid and sheet. CPU seconds, least of several runs; `cut`: triangles of the solid that are
/// cut.
double floor_seconds(const geo::TriangleMesh& solid, const geo::TriangleMesh& sheet, int runs, std::size_t& cut);

}  // namespace bench
