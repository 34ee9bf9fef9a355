// NodeSet and sample. Arrays are views whose base is the object itself.
#include "nodes.h"

#include <cmath>
#include <string>

#include "arguments.h"
#include "bind.h"
#include "complex.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "progress.h"

namespace kerf_python {
namespace {

// A positive number of model units, or a text such as "3%" of `diagonal`.
double spacing_from(py::handle spacing, double diagonal) {
  constexpr const char* wanted = "spacing: give a positive number of model units, or a percentage such as '3%'";
  double value = 0;
  if (py::isinstance<py::str>(spacing)) {
    const auto text = spacing.cast<std::string>();
    std::size_t used = 0;
    try {
      value = std::stod(text, &used);
    } catch (const std::exception&) {
    }
    if (used == 0 || (used != text.size() && text.substr(used) != "%")) throw geo::InputError(wanted);
    if (used != text.size()) value *= diagonal / 100;
  } else {
    value = PyFloat_AsDouble(spacing.ptr());
    if (PyErr_Occurred()) {
      PyErr_Clear();
      throw geo::InputError(wanted);
    }
  }
  if (!(value > 0) || !std::isfinite(value)) throw geo::InputError(wanted);
  return value;
}

std::vector<double> positive_from(py::handle object, const char* name, std::size_t count) {
  auto values = numbers_from(object, name);
  if (values.size() != count)
    throw geo::InputError(std::string(name) + ": " + std::to_string(values.size()) + " values for " +
                          std::to_string(count) + " nodes; give one per node");
  for (std::size_t i = 0; i < count; ++i)
    if (!(values[i] > 0))
      throw geo::InputError(std::string(name) + ": value at " + std::to_string(i) + " is not positive; correct it");
  return values;
}

NodeSet made(py::object positions, py::object radius, py::object spacing, py::object volume) {
  geo::NodeSet nodes;
  nodes.position = points_from(positions, "positions");
  const auto count = nodes.position.size();
  nodes.radius = positive_from(radius, "radius", count);
  nodes.spacing = positive_from(spacing, "spacing", count);
  nodes.volume = positive_from(volume, "volume", count);
  return NodeSet(std::move(nodes));
}

NodeSet sampled(py::object model, const SampleArguments& arguments, py::object progress) {
  const auto solid = solid_argument(model, "model");
  const auto options = sample_options(arguments, geo::bounding_box(solid->mesh).diagonal());
  ProgressReport report(std::move(progress));
  return NodeSet(report.run([&](geo::Progress p) { return geo::sample_nodes(solid->mesh, options, p); }));
}

py::dict thin_material(const NodeSet& self, py::object model, double across) {
  const auto solid = solid_argument(model, "model");
  const auto thin = without_gil([&] { return geo::find_thin_material(solid->mesh, *self.nodes, across); });
  py::dict found;
  found["share"] = thin.share;
  found["thickness"] = thin.thickness;
  found["spacing"] = thin.spacing;
  found["at"] = py::make_tuple(thin.at.x(), thin.at.y(), thin.at.z());
  found["enough"] = thin.enough;
  return found;
}

py::array array_of(const py::object& self, const std::vector<double> geo::NodeSet::*member) {
  const auto& values = (*self.cast<const NodeSet&>().nodes).*member;
  return view<double>(values.data(), {static_cast<py::ssize_t>(values.size())}, self);
}

void save(const NodeSet& self, const Path& path) {
  const GilRelease release;
  geo::write_all(path, [&](std::ostream& out) {
    path.text.ends_with(".ply") ? geo::write_nodes_ply(out, *self.nodes) : geo::write_pcd(out, *self.nodes);
  });
}

constexpr const char* nodes_doc =
    "Simulation nodes (section 3.1). They never change; arrays are read-only views.\n\n"
    "NodeSet(positions, radius, spacing, volume): (n, 3) positions inside the material, and per node the support\n"
    "radius, the spacing and the volume of material, (n,), all positive; model units. Raises InputError.";
constexpr const char* sample_doc =
    "Samples a solid with nodes inside it, finer at the surface than in the depth (section 3.1, 6.4).\n\n"
    "model: Solid, Complex, or a mesh that is a solid. spacing: cells at the surface, a number of model units or '3%' "
    "of the\n"
    "diagonal; None: 3 %, or what count requires. count: wanted number of nodes. levels: of resolution, 1 to 10.\n"
    "jitter: random displacement as a fraction of the cell. support: support radius in spacings. pattern: 'jitter',\n"
    "'blue' or 'grid'. across: nodes wanted across thin material. Deterministic for a seed. Returns a NodeSet.\n"
    "Raises InputError for options out of range, or a model that is no solid.";

}  // namespace

geo::SampleOptions sample_options(const SampleArguments& a, double diagonal) {
  geo::SampleOptions options;
  if (!a.spacing.is_none() && !a.count.is_none()) throw geo::InputError("spacing, count: give one of them");
  if (!a.spacing.is_none()) options.spacing = spacing_from(a.spacing, diagonal);
  if (!a.count.is_none()) {
    const auto count = PyLong_AsLongLong(a.count.ptr());
    if (PyErr_Occurred()) PyErr_Clear();
    if (count < 1 || count > 100000000) throw geo::InputError("count: give an integer from 1 to 100000000");
    options.count = static_cast<std::size_t>(count);
  }
  if (a.pattern == "blue")
    options.pattern = geo::NodePattern::blue;
  else if (a.pattern == "grid")
    options.pattern = geo::NodePattern::grid;
  else if (a.pattern != "jitter")
    throw geo::InputError("pattern: '" + a.pattern + "' is unknown; give 'jitter', 'blue' or 'grid'");
  if (a.across < 0 || a.across > 100) throw geo::InputError("across: give an integer from 0 to 100");
  options.levels = a.levels;
  options.jitter = a.jitter;
  options.support = a.support;
  options.seed = a.seed;
  options.across = a.across;
  return options;
}

std::shared_ptr<const Mesh> solid_argument(py::handle object, const std::string& name) {
  if (py::isinstance<Complex>(object)) {
    auto& complex = object.cast<Complex&>();
    const Reading reading(complex.busy);
    return without_gil([&] { return std::make_shared<Mesh>(complex.complex.two_sided()); });
  }
  auto mesh = mesh_argument(object, name);
  if (mesh->is_model()) return mesh;
  const GilRelease release;
  try {
    geo::require_solid(mesh->mesh);
  } catch (const geo::InputError& e) {
    throw geo::InputError(name + ": " + e.what());
  }
  return mesh;
}

void bind_nodes(py::module_& module) {
  py::class_<NodeSet, std::shared_ptr<NodeSet>>(module, "NodeSet", nodes_doc)
      .def(py::init(&made), py::arg("positions"), py::arg("radius"), py::arg("spacing"), py::arg("volume"),
           "See the class.")
      .def_property_readonly(
          "positions",
          [](const py::object& self) {
            const auto& p = self.cast<const NodeSet&>().nodes->position;
            return view<double>(p.data(), {static_cast<py::ssize_t>(p.size()), 3}, self);
          },
          "Positions in material coordinates, (n, 3) float64, model units. Read-only view.")
      .def_property_readonly(
          "radius", [](const py::object& self) { return array_of(self, &geo::NodeSet::radius); },
          "Support radius of each node, (n,) float64, model units. Read-only view.")
      .def_property_readonly(
          "spacing", [](const py::object& self) { return array_of(self, &geo::NodeSet::spacing); },
          "Edge length of each node's cell, (n,) float64, model units. Read-only view.")
      .def_property_readonly(
          "volume", [](const py::object& self) { return array_of(self, &geo::NodeSet::volume); },
          "Volume of material that each node owns, (n,) float64, model units cubed. Read-only view.")
      .def("__len__", [](const NodeSet& self) { return self.nodes->size(); })
      .def("__repr__",
           [](const NodeSet& self) { return "<kerf.NodeSet of " + std::to_string(self.nodes->size()) + " nodes>"; })
      .def("save", &save, py::arg("path"), "Writes PLY where the path ends in .ply, else PCD. Raises OutputError.")
      .def_static(
          "load",
          [](const Path& path) {
            const GilRelease release;
            return NodeSet(geo::read_nodes(path));
          },
          py::arg("path"), "Reads PCD or PLY with radius, spacing and volume. Raises InputError.")
      .def("thin_material", &thin_material, py::arg("model"), py::arg("across") = 2.0,
           "Walls of a model with fewer than `across` spacings of these nodes between their two sides, as a dict:\n"
           "share, of the surface that such walls have, 0 to 1; thickness, below which half of them are, 0: none;\n"
           "spacing, of the nodes there; at, a point in such a wall; enough, the spacing that is needed. Model units.\n"
           "With fewer than two, a wall bends too little. Raises InputError for a model that is no solid.");
  module.def(
      "sample",
      [](py::object model, py::object spacing, py::object count, int levels, double jitter, double support,
         std::uint64_t seed, const std::string& pattern, int across, py::object progress) {
        return sampled(std::move(model), {spacing, count, levels, jitter, support, seed, pattern, across},
                       std::move(progress));
      },
      py::arg("model"), py::kw_only(), py::arg("spacing") = py::none(), py::arg("count") = py::none(),
      py::arg("levels") = 2, py::arg("jitter") = 0.15, py::arg("support") = 1.8, py::arg("seed") = 1,
      py::arg("pattern") = "jitter", py::arg("across") = 0, py::arg("progress") = py::none(), sample_doc);
}

}  // namespace kerf_python
