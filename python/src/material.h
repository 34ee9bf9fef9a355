// Materials between Python and the library.
#pragma once

#include <string>

#include "arrays.h"
#include "kerf/material.h"

namespace kerf_python {

/// The materials of an argument: one Material for all nodes, or Materials. Throws py::type_error.
geo::Materials materials_argument(py::handle object);
/// An array of shape (3, 3), or (n, 3, 3), of finite numbers as matrices. Throws geo::InputError.
std::vector<geo::Mat3> matrices_from(py::handle object, const std::string& name);
/// Matrices as an array (n, 3, 3).
py::array moved_matrices(const std::vector<geo::Mat3>& matrices);

}  // namespace kerf_python
