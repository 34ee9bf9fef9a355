// A cube as a body, and edges that pass it.
#pragma once

#include <vector>

#include "kerf/body.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

namespace geo {

inline Body cube() {
  const TriangleMesh mesh = make_block({1, 1, 1}, 0.25);
  return build_body(Complex::from_skin(mesh), sample_nodes(mesh, {.spacing = 0.2}));
}

inline std::vector<Vec3> edge(double x) { return {{x, -0.3, 0.52}, {x, 1.3, 0.47}}; }

}  // namespace geo
