// A crack given as a whole surface, not as the trace of a front.
#pragma once

#include "crack/advance.h"
#include "surface/triangle_mesh.h"

namespace geo {

/// Inserts what of `sheet` lies in the material as one crack, in one step: any triangles, connected or not, crossing
/// themselves or not; patch and site are ignored. Throws InputError for a sheet with rows out of range or coordinates
/// that are not finite, GeometryError when no attempt passes the guard; `complex` is then unchanged.
CrackDelta insert_sheet(Complex& complex, const TriangleMesh& sheet, std::int32_t crack, const CrackOptions& options = {},
                        CrackWork* work = nullptr);

}  // namespace geo
