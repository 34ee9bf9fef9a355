// The parts of the extension kerf._formats.
#pragma once

#include <pybind11/pybind11.h>

namespace kerf_python {

void bind_volumes(pybind11::module_& module);  ///< OpenVDB volumes

}  // namespace kerf_python
