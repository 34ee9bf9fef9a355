// Poses of rigid objects between Python and the library.
#pragma once

#include <string>

#include "arrays.h"
#include "kerf/scene.h"

namespace kerf_python {

/// A pose: a position; a pair of a position and a quaternion (w, x, y, z); or a rigid 4 × 4 matrix.
/// Throws geo::InputError.
geo::Pose pose_from(py::handle object, const std::string& name);
/// A pose as a pair of a position, (3,), and a unit quaternion (w, x, y, z), (4,).
py::tuple pose_to(const geo::Pose& pose);

}  // namespace kerf_python
