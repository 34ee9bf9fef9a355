// Procedural models: the functions of kerf.shapes.
#include <pybind11/stl.h>

#include "arguments.h"
#include "bind.h"
#include "busy.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "mesh.h"

namespace kerf_python {
namespace {

// 20 · 500² triangles are five million.
int frequency_from(py::handle given) {
  const auto frequency = integer_from(given, "frequency");
  if (frequency < 1 || frequency > 500) throw geo::InputError("frequency: give 1 to 500");
  return static_cast<int>(frequency);
}

std::shared_ptr<Solid> solid(geo::TriangleMesh&& mesh) { return std::make_shared<Solid>(std::move(mesh), true); }

using Maker = geo::TriangleMesh (*)(int);

auto geodesic(Maker make) {
  return [make](const py::object& frequency) {
    const int n = frequency_from(frequency);
    return solid(without_gil([&] { return make(n); }));
  };
}

std::shared_ptr<Solid> star(const py::object& frequency, const py::object& radius) {
  const int n = frequency_from(frequency);
  if (!PyCallable_Check(radius.ptr())) throw py::type_error("radius: give a callable of a direction, (3,)");
  const auto mesh = geo::make_star(n, [&](const geo::Vec3& direction) {
    const py::object given = radius(point(direction));
    const double value = PyFloat_AsDouble(given.ptr());
    if (PyErr_Occurred()) throw py::error_already_set();
    if (!(value > 0 && value <= geo::largest_coordinate))
      throw geo::InputError("radius: is " + std::to_string(value) + "; return a positive number");
    return value;
  });
  return std::make_shared<Solid>(mesh);
}

std::shared_ptr<Solid> block(const py::object& size, double edge) {
  const auto given = point_from(size, "size");
  if (!(given.minCoeff() > 0) || !(edge > 0)) throw geo::InputError("block: size and edge must be positive");
  if (!((given / edge).maxCoeff() <= 2000))
    throw geo::InputError("block: edge makes over 2000 cells; let it be longer");
  return solid(without_gil([&] { return geo::make_block(given, edge); }));
}

std::shared_ptr<Solid> letter(const std::string& text, double depth, int resolution) {
  if (text.size() != 1) throw geo::InputError("letter: give one of A to Z");
  if (!(depth > 0 && depth <= 1e6) || resolution < 12 || resolution > 1000 || depth * resolution > 1e5)
    throw geo::InputError("letter: depth must be positive, resolution from 12 to 1000, not too many cells deep");
  return solid(without_gil([&] { return geo::make_letter(text[0], depth, resolution); }));
}

}  // namespace

void bind_shapes(py::module_& module) {
  auto shapes = module.def_submodule("_shapes");
  shapes.def(
      "star", &star, py::arg("frequency"), py::arg("radius"),
      "A geodesic sphere of 20 frequency² triangles whose point in unit direction d is radius(d) d; radius is a\n"
      "callable of (3,) float64. Frequency: 1 to 500. Returns a Solid. Raises InputError unless every radius is\n"
      "positive and the result is a valid solid.");
  shapes.def("sphere", geodesic(geo::make_sphere), py::arg("frequency") = 8,
             "A unit sphere of 20 frequency² triangles, a Solid. Raises InputError unless frequency is 1 to 500.");
  shapes.def(
      "pumpkin", geodesic(geo::make_pumpkin), py::arg("frequency") = 24,
      "A pumpkin with nine lobes, about 2 units across, 20 frequency² triangles, a Solid. Raises InputError unless\n"
      "frequency is 1 to 500.");
  shapes.def(
      "apple", geodesic(geo::make_apple), py::arg("frequency") = 24,
      "An apple, about 2 units across, 20 frequency² triangles, a Solid. Raises InputError unless frequency is 1\n"
      "to 500.");
  shapes.def(
      "polyp", geodesic(geo::make_polyp), py::arg("frequency") = 24,
      "A bulb on a thin stalk, z upwards, about 2 units tall, 20 frequency² triangles, a Solid. Raises InputError\n"
      "unless frequency is 1 to 500.");
  shapes.def(
      "block", &block, py::arg("size") = py::make_tuple(1, 1, 1), py::arg("edge") = 1.0,
      "An axis-aligned block from the origin to `size`, three numbers, no edge along an axis longer than `edge`,\n"
      "model units; a Solid. Raises InputError unless both are positive.");
  shapes.def(
      "letter", &letter, py::arg("letter"), py::arg("depth") = 0.3, py::arg("resolution") = 12,
      "A capital letter A to Z of height 1, extruded to `depth` along z; resolution: cells per unit of height, 12\n"
      "to 1000. Returns a Solid. Raises InputError.");
}

}  // namespace kerf_python
