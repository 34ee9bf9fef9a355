// Material, Materials, and the hyperelastic laws.
#include "material.h"

#include <pybind11/stl.h>

#include "bind.h"
#include "kerf/error.h"
#include "keywords.h"

namespace kerf_python {
namespace {

constexpr const char* model_names[] = {"stvk", "neo-hookean"};
constexpr const char* discretisation_names[] = {"galerkin", "mueller04"};

// The index of a name in a pair of names.
int choice(const py::object& given, const char* const (&names)[2], int unless, const char* what) {
  if (given.is_none()) return unless;
  if (py::isinstance<py::str>(given)) {
    const auto name = given.cast<std::string>();
    for (int i = 0; i < 2; ++i)
      if (name == names[i]) return i;
  }
  throw geo::InputError(std::string("Material: ") + what + " must be '" + names[0] + "' or '" + names[1] + "'");
}

geo::Material changed(geo::Material m, const py::kwargs& given) {
  Keywords k(given, "Material");
  m.model = static_cast<geo::ElasticModel>(choice(k.object("model"), model_names, static_cast<int>(m.model), "model"));
  m.discretisation = static_cast<geo::Discretisation>(
      choice(k.object("discretisation"), discretisation_names, static_cast<int>(m.discretisation), "discretisation"));
  k.take("young", m.young);
  k.take("poisson", m.poisson);
  k.take("density", m.density);
  k.take("volume_term", m.volume_term);
  k.take("damping", m.damping);
  k.take("viscosity", m.viscosity);
  k.take("mode_penalty", m.mode_penalty);
  k.take("yield_", m.yield);
  k.take("creep", m.creep);
  k.take("max_plastic", m.max_plastic);
  k.finish();
  geo::require_material(m);
  return m;
}

geo::Mat3 gradient_from(py::handle object) {
  const auto matrices = matrices_from(object, "f");
  if (matrices.size() != 1) throw geo::InputError("f: give one deformation gradient, (3, 3)");
  return matrices[0];
}

std::vector<std::uint16_t> index_from(py::handle object, std::size_t count) {
  if (object.is_none()) return {};
  const auto values = integers_from(object, "index", 0, static_cast<std::int64_t>(count) - 1);
  return {values.begin(), values.end()};
}

geo::Materials table_of(const std::vector<geo::Material>& table, py::object index) {
  if (table.empty()) throw geo::InputError("table: give one material at least");
  if (table.size() > 65535) throw geo::InputError("table: more than 65535 materials; give fewer");
  if (table.size() > 1 && index.is_none()) throw geo::InputError("index: give the material of each node");
  return geo::Materials(table, index_from(index, table.size()));
}

constexpr const char* material_doc =
    "Parameters of a hyperelastic material; model units are metres. It never changes: see replace().\n\n"
    "Material(*, model='neo-hookean' or 'stvk', young=1e5 (Pa), poisson=0.3, density=1000 (kg/m3), volume_term=0 "
    "(Pa),\n"
    "damping=0 (1/s), viscosity=0 (Pa s), discretisation='galerkin' or 'mueller04', mode_penalty=0.05, yield_=0\n"
    "(elastic strain above which it flows; 0: never), creep=1 (1/s), max_plastic=1). Raises InputError for impossible\n"
    "values, TypeError for unknown names.";

void bind_one(py::module_& module) {
  using geo::Material;
  py::class_<Material>(module, "Material", material_doc)
      .def(py::init([](const py::kwargs& given) { return changed({}, given); }), "See the class.")
      .def(
          "replace", [](const Material& self, const py::kwargs& given) { return changed(self, given); },
          "A copy with other values; arguments as for the class. Raises InputError.")
      .def_property_readonly(
          "model", [](const Material& m) { return model_names[static_cast<int>(m.model)]; }, "'stvk' or 'neo-hookean'.")
      .def_property_readonly(
          "discretisation", [](const Material& m) { return discretisation_names[static_cast<int>(m.discretisation)]; },
          "'galerkin' or 'mueller04': where strain energy is integrated.")
      .def_readonly("young", &Material::young, "Young's modulus, Pa.")
      .def_readonly("poisson", &Material::poisson, "Poisson's ratio.")
      .def_readonly("density", &Material::density, "Density, kg/m3.")
      .def_readonly("volume_term", &Material::volume_term, "k_v of the term against collapse, Pa.")
      .def_readonly("damping", &Material::damping, "Damping proportional to mass, 1/s.")
      .def_readonly("viscosity", &Material::viscosity, "Viscosity of the Green strain, Pa s.")
      .def_readonly("mode_penalty", &Material::mode_penalty, "mueller04: penalty on modes without energy.")
      .def_readonly("yield_", &Material::yield, "Elastic strain above which material flows; 0: never.")
      .def_readonly("creep", &Material::creep, "Fraction of the elastic strain that flows per second.")
      .def_readonly("max_plastic", &Material::max_plastic, "Largest norm of the plastic strain.")
      .def_property_readonly("lame_lambda", &Material::lambda, "Lame's first parameter, Pa.")
      .def_property_readonly("lame_mu", &Material::mu, "Shear modulus, Pa.")
      .def(
          "__eq__", [](const Material& a, const Material& b) { return a == b; }, py::is_operator())
      .def("__repr__",
           [](const Material& m) {
             return "<kerf.Material " + std::string(model_names[static_cast<int>(m.model)]) +
                    ", young=" + py::repr(py::float_(m.young)).cast<std::string>() +
                    ", poisson=" + py::repr(py::float_(m.poisson)).cast<std::string>() + ">";
           })
      .attr("__hash__") = py::none();
}

}  // namespace

geo::Materials materials_argument(py::handle object) {
  if (py::isinstance<geo::Materials>(object)) return object.cast<geo::Materials>();
  if (py::isinstance<geo::Material>(object)) return geo::Materials(object.cast<geo::Material>());
  throw py::type_error("materials: give a kerf.Material, or kerf.Materials");
}

std::vector<geo::Mat3> matrices_from(py::handle object, const std::string& name) {
  const auto [shape, values] = values_from(object, name, 2, 3);
  const auto n = shape.size();
  if (shape[n - 1] != 3 || shape[n - 2] != 3) throw geo::InputError(name + ": give (3, 3) or (n, 3, 3) numbers");
  std::vector<geo::Mat3> out(n == 3 ? shape[0] : 1);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&values[9 * i]);
  return out;
}

py::array moved_matrices(const std::vector<geo::Mat3>& matrices) {
  std::vector<std::array<double, 9>> rows(matrices.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows[i].data()) = matrices[i];
  return moved<double>(std::move(rows), {3, 3});
}

void bind_material(py::module_& module) {
  bind_one(module);
  py::class_<geo::Materials>(
      module, "Materials",
      "The materials of a solid: a table, and per node an index into it. Nodes of one component\n"
      "of the graph must share a material.\n\n"
      "Materials(table, index=None): a list of Material; (n,) integers, None with one material.\n"
      "Raises InputError.")
      .def(py::init(&table_of), py::arg("table"), py::arg("index") = py::none(), "See the class.")
      .def("__len__", &geo::Materials::count, "Number of materials in the table.")
      .def("__getitem__",
           [](const geo::Materials& self, std::int64_t i) {
             const auto count = static_cast<std::int64_t>(self.count());
             if (i < -count || i >= count)
               throw py::index_error("index " + std::to_string(i) + " is out of range; there are " +
                                     std::to_string(count) + " materials");
             return self[static_cast<std::size_t>(i < 0 ? i + count : i)];
           })
      .def(
          "fits", [](const geo::Materials& self, std::size_t nodes) { return self.fits(nodes); }, py::arg("nodes"),
          "Whether every one of this number of nodes has a material.");
  module.def(
      "energy_density",
      [](const geo::Material& material, py::object f) { return geo::energy_density(material, gradient_from(f)); },
      py::arg("material"), py::arg("f"),
      "Energy density at deformation gradient f, (3, 3), J/m3; 0 at rotations. Raises InputError.");
  module.def(
      "stress",
      [](const geo::Material& material, py::object f) {
        const geo::Mat3 p = geo::stress(material, gradient_from(f));
        return moved_matrices({p}).attr("__getitem__")(0);
      },
      py::arg("material"), py::arg("f"),
      "First Piola-Kirchhoff stress at deformation gradient f, (3, 3) float64, Pa. Raises InputError.");
}

}  // namespace kerf_python
