// Shorter edges where a mesh is coarser than what it is to touch, or than it is to bend.
#pragma once

#include "surface/triangle_mesh.h"

namespace geo {

/// A plain mesh (no sites) with edges of `longest` at most, model units: longer ones are divided in the middle, again and again, the same for
/// both triangles of each. The shape stays to rounding, vertices keep their rows, triangles come in the order of those that they
/// are parts of; attributes are interpolated. An edge whose middle is one of its ends by rounding stays. Throws InputError where more than 20
/// million triangles would come of it.
TriangleMesh refined(const TriangleMesh& mesh, double longest);

}  // namespace geo
