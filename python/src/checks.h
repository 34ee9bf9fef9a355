// Reports on surfaces and complexes as Python sees them.
#pragma once

#include <pybind11/pybind11.h>

#include "kerf/check.h"

namespace kerf_python {

/// The number of triangles with a vertex twice.
std::size_t collapsed_triangles(const geo::TriangleMesh& mesh);

}  // namespace kerf_python
