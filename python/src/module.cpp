// The extension kerf._kerf: the order in which classes are registered, so that signatures name
// them.
#include "bind.h"

PYBIND11_MODULE(_kerf, module) {
  using namespace kerf_python;
  module.doc() = "Classes and functions of the package kerf; import that.";
  module.attr("__version__") = KERF_VERSION;
  py::options options;
  options.disable_enum_members_docstring();
  bind_errors(module);
  bind_threads(module);
  bind_mesh(module);
}
