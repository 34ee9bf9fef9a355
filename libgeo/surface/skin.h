// The skin of a crack complex as a mesh.
#pragma once

#include "kerf/complex.h"
#include "kerf/mesh.h"

namespace geo {

/// The living faces of K that are not crack faces, each once: the uncut surface. Vertices are those
/// of K, by id; some may have no triangle.
TriangleMesh skin_of(const Complex& complex);

}  // namespace geo
