// Formats that hold triangles alone: STL and OFF.
#pragma once

#include <ostream>

#include "kerf/mesh.h"

namespace kerf_python {

/// Writes binary STL: normals and corners of triangles in single precision.
void write_stl(std::ostream& out, const geo::TriangleMesh& mesh);
/// Writes OFF as text; every coordinate returns to the bit.
void write_off(std::ostream& out, const geo::TriangleMesh& mesh);

}  // namespace kerf_python
