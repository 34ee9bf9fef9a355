// Files of fronts and curves: `.front` text, and OBJ with polylines.
#include <pybind11/stl.h>

#include "arguments.h"
#include "bind.h"
#include "busy.h"
#include "fronts.h"
#include "kerf/files.h"

namespace kerf_python {
namespace {

std::vector<std::shared_ptr<geo::Front>> shared(std::vector<geo::Front>&& fronts) {
  std::vector<std::shared_ptr<geo::Front>> out;
  for (auto& front : fronts) out.push_back(std::make_shared<geo::Front>(std::move(front)));
  return out;
}

}  // namespace

void bind_front_files(py::module_& module) {
  module.def(
      "load_fronts", [](const Path& path) { return shared(without_gil([&] { return geo::read_fronts(path.text); })); },
      py::arg("path"),
      "Reads fronts and sheets from `.front` text or OBJ polylines (docs/formats.md): a list of Front. Raises "
      "InputError,\n"
      "with the line, for a malformed file.");
  module.def(
      "load_curves", [](const Path& path) { return shared(without_gil([&] { return geo::read_curves(path.text); })); },
      py::arg("path"),
      "Reads curves for score(pattern=\"curves\"): as load_fronts(), but one step is enough. Raises InputError.");
  module.def(
      "parse_fronts",
      [](const py::bytes& data, const std::string& name) {
        const auto text = data.cast<std::string>();
        return shared(without_gil([&] { return geo::parse_fronts(text, name); }));
      },
      py::arg("data"), py::arg("name") = "bytes",
      "As load_fronts(), from bytes in memory; `name` stands for the file in messages. Raises InputError.");
  module.def(
      "save_fronts",
      [](const Path& path, const py::object& fronts) {
        const auto given = fronts_from(fronts, "fronts");
        without_gil([&] { geo::write_all(path.text, [&](std::ostream& out) { geo::write_fronts(out, given); }); });
      },
      py::arg("path"), py::arg("fronts"),
      "Writes `.front` text: a Front, a list of them, an array (steps, points, 3) or a list of lines. Numbers are "
      "read\n"
      "back exactly. Raises OutputError where it cannot be written, InputError for other objects.");
}

}  // namespace kerf_python
