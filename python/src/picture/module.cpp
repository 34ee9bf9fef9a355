// The extension kerf._picture: kerf/_pictures.py checks the arguments and calls it.
#include <pybind11/stl.h>

#include <sstream>

#include "../apart.h"
#include "../arrays.h"
#include "../gil.h"
#include "../mesh.h"
#include "../progress.h"
#include "drawing.h"
#include "kerf/error.h"

namespace kerf_python {
namespace {

using Meshes = std::vector<std::shared_ptr<Mesh>>;

view::Look look_from(const py::dict& given) {
  view::Look look;
  look.coloring = view::coloring_of(given["color"].cast<std::string>());
  look.skin = view::parse_color(given["skin"].cast<std::string>());
  look.wire = given["wire"].cast<bool>();
  look.opacity = given["opacity"].cast<double>();
  look.sheets = given["sheets"].cast<bool>();
  look.seams = given["seams"].cast<bool>();
  look.explode = given["explode"].cast<double>();
  look.section = !given["hollow"].cast<bool>();
  if (!given["cut_away"].is_none()) {
    const auto plane = given["cut_away"].cast<std::array<double, 4>>();
    look.cutaway = view::RelativePlane{{plane[0], plane[1], plane[2]}, plane[3]};
  }
  return look;
}

py::array picture(const Meshes& surfaces, const Meshes& obstacles, const py::dict& nodes, const py::dict& look,
                  const py::dict& view, py::object progress) {
  const auto shared = std::make_shared<Drawing>();  // the thread that draws may outlast this call
  Drawing& drawing = *shared;
  for (const auto& mesh : surfaces) drawing.surfaces.push_back(&mesh->mesh);
  for (const auto& mesh : obstacles) drawing.obstacles.push_back(&mesh->mesh);
  drawing.look = look_from(look);
  drawing.ground = look["ground"].cast<bool>();
  if (!look["values"].is_none()) drawing.values = numbers_from(look["values"], "color");
  if (!look["range"].is_none()) drawing.range = look["range"].cast<std::pair<double, double>>();
  if (nodes.contains("positions")) {
    drawing.nodes.positions = points_from(nodes["positions"], "nodes");
    drawing.nodes.spacing = numbers_from(nodes["spacing"], "nodes");
    if (!nodes["values"].is_none()) drawing.nodes.values = numbers_from(nodes["values"], "field");
    if (!nodes["edges"].is_none()) drawing.nodes.edges = nodes["edges"].cast<decltype(drawing.nodes.edges)>();
    drawing.look.section = false;
  }
  std::tie(drawing.options.width, drawing.options.height) = view["size"].cast<std::pair<int, int>>();
  std::tie(drawing.camera.azimuth, drawing.camera.elevation) = view["camera"].cast<std::pair<double, double>>();
  drawing.camera.zoom = view["zoom"].cast<double>();
  drawing.camera.y_up = view["y_up"].cast<bool>();
  drawing.options.samples = view["samples"].cast<int>();
  const auto work = [shared, surfaces, obstacles](const geo::Progress& own) {
    return view::rgb_bytes(draw(*shared, own));
  };
  auto bytes = stoppable("render", work, std::move(progress));
  using Pixels = std::vector<std::array<std::uint8_t, 3>>;
  Pixels pixels(bytes.size() / 3);
  std::copy(bytes.begin(), bytes.end(), pixels.empty() ? nullptr : pixels[0].data());
  const auto flat = moved<std::uint8_t>(std::move(pixels), {3});
  return flat.attr("reshape")(drawing.options.height, drawing.options.width, 3).cast<py::array>();
}

py::bytes png(const py::array_t<std::uint8_t, py::array::c_style>& pixels) {
  if (pixels.ndim() != 3 || pixels.shape(2) != 3) throw geo::InputError("png: give (height, width, 3) bytes");
  std::ostringstream out;
  view::write_png(out, pixels.data(), static_cast<int>(pixels.shape(1)), static_cast<int>(pixels.shape(0)));
  return py::bytes(out.str());
}

}  // namespace
}  // namespace kerf_python

PYBIND11_MODULE(_picture, module) {
  namespace py = pybind11;
  module.doc() = "The renderer behind kerf.picture(); use that.";
  py::module_::import("kerf._kerf");  // its classes are the arguments
  module.def("picture", &kerf_python::picture, py::arg("surfaces"), py::arg("obstacles"), py::arg("nodes"),
             py::arg("look"), py::arg("view"), py::arg("progress"),
             "Draws meshes and nodes; see kerf/_pictures.py. Returns (h, w, 3) uint8.");
  module.def("png", &kerf_python::png, py::arg("pixels"), "A PNG of (h, w, 3) bytes, sRGB.");
  kerf_python::wait_for_threads_at_exit();
  kerf_python::stop_calls_at_exit();
}
