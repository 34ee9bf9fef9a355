// Parts of the binding (§ 6.5) that the build and the split share.
#pragma once

#include "body/body.h"

namespace geo {

/// The closest surface vertex within `reach` that p sees, of the fan that it sees; invalid when there is none. Exact.
SurfaceVertexId closest_vertex(const Complex& complex, const Vec3& p, double reach);

/// Masters from binding.closest, then slaves breadth-first: a function of complex, nodes and closest vertices alone.
/// Cost: once over the surface.
void grow_trees(Body& body);

}  // namespace geo
