// The parts of the extension kerf._formats.
#pragma once

#include <pybind11/pybind11.h>

namespace kerf_python {

void bind_volumes(pybind11::module_& module);  ///< OpenVDB volumes
void bind_vtkhdf(pybind11::module_& module);   ///< graphs of bodies as VTKHDF

}  // namespace kerf_python
