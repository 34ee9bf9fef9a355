// The parts of the extension kerf._kerf: each source adds its classes and functions to the module.
#pragma once

#include <pybind11/pybind11.h>

namespace kerf_python {

namespace py = pybind11;

void bind_errors(py::module_& module);   ///< exceptions; first
void bind_threads(py::module_& module);  ///< number of threads
void bind_mesh(py::module_& module);     ///< Mesh and Solid

}  // namespace kerf_python
