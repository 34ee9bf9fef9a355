// The extension kerf._formats: what needs OpenVDB or HDF5, loaded with the first call that does.
#include "formats.h"

#include "../apart.h"
#include "../gil.h"

PYBIND11_MODULE(_formats, module) {
  using namespace kerf_python;
  module.doc() = "Formats of files that need large libraries; the package kerf loads this.";
  pybind11::module_::import("kerf._kerf");  // the classes of arguments and results
  bind_volumes(module);
  bind_vtkhdf(module);
  wait_for_threads_at_exit();
  stop_calls_at_exit();
}
