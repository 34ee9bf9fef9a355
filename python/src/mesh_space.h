// Planes, as sheets that cut a model.
#pragma once

#include "kerf/mesh.h"
#include "mesh.h"

namespace kerf_python {

/// A plane without end.
struct Plane {
  geo::Vec3 point, normal;  ///< the normal has length 1
};

/// A sheet in the plane that divides a model in this box.
geo::TriangleMesh sheet_across(const Plane& plane, const geo::Box3& box);

}  // namespace kerf_python
