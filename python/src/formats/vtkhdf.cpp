// Graphs of bodies as VTKHDF. Body.save_graph() loads the extension for them.
#include "../gil.h"
#include "formats.h"

#include "../arguments.h"
#include "../body.h"
#include "kerf/export.h"
#include "kerf/files.h"

namespace {

namespace py = pybind11;

void write_vtkhdf(kerf_python::Body& body, const kerf_python::Path& path) {
  const kerf_python::Reading reading(body.busy);
  const kerf_python::GilRelease release;
  geo::write_all(path, [&](std::ostream& out) { geo::write_vtkhdf(out, body.body); });
}

}  // namespace

namespace kerf_python {

void bind_vtkhdf(py::module_& module) {
  module.def("write_vtkhdf", &write_vtkhdf, py::arg("body"), py::arg("path"),
             "Writes the graph of a body as VTKHDF. Raises OutputError.");
}

}  // namespace kerf_python
