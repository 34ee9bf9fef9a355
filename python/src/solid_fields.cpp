// Energy, forces, stress and momentum of a solid in a state; its time steps.
#include <cmath>
#include <optional>
#include <string>

#include "bind.h"
#include "kerf/error.h"
#include "material.h"
#include "solid.h"

namespace kerf_python {
namespace {

using Solids = py::class_<DeformingSolid, std::shared_ptr<DeformingSolid>>;
using Vectors = std::vector<geo::Vec3>;

// The displacements of an argument: an array, or those of a State.
Vectors displacements(const DeformingSolid& self, py::handle object) {
  require_points(self);
  if (!py::isinstance<State>(object)) return vectors_from(object, "u", self.solid.size());
  auto& state = object.cast<State&>();
  const Reading reading(state.busy);
  require_fit(self, state);
  return state.state.displacement;
}

// A State, or one of displacements alone.
geo::State state_of(const DeformingSolid& self, py::handle object) {
  require_points(self);
  if (!py::isinstance<State>(object)) return {.displacement = vectors_from(object, "u", self.solid.size())};
  auto& state = object.cast<State&>();
  const Reading reading(state.busy);
  require_fit(self, state);
  return state.state;
}

py::tuple stencil(DeformingSolid& self, std::int64_t node) {
  const Reading reading(self.busy);
  if (node < 0 || static_cast<std::size_t>(node) >= self.solid.size())
    throw geo::InputError("node " + std::to_string(node) + " is out of range");
  std::vector<std::pair<geo::NodeId, geo::Vec3>> out;
  self.solid.gradient_stencil(geo::NodeId(static_cast<std::uint32_t>(node)), out);
  std::vector<std::uint32_t> nodes;
  Vectors weights;
  for (const auto& [j, g] : out) {
    nodes.push_back(j.value);
    weights.push_back(g);
  }
  return py::make_tuple(moved<std::uint32_t>(std::move(nodes)), moved_points(std::move(weights)));
}

py::object stress_at(DeformingSolid& self, State& state, py::object x, double radius, py::object sees) {
  const Reading reading(self.busy), still(state.busy);
  require_fit(self, state);
  if (!(radius > 0) || !std::isfinite(radius)) throw geo::InputError("radius: give a positive number");
  const auto at = point_from(x, "x");
  std::function<bool(const geo::Vec3&)> accepts;
  if (!sees.is_none())
    accepts = [&](const geo::Vec3& p) {
      const GilAcquire gil;
      return PyObject_IsTrue(sees(point(p)).ptr()) == 1;
    };
  const auto out = without_gil([&] { return self.solid.stress_at(state.state, at, radius, accepts); });
  return moved_matrices({out}).attr("__getitem__")(0);
}

// A total of a state.
template <class T>
auto total(T (geo::Solid::*sum)(const geo::State&) const) {
  return [sum](DeformingSolid& self, State& state) {
    const Reading reading(self.busy), still(state.busy);
    require_fit(self, state);
    const T out = without_gil([&] { return (self.solid.*sum)(state.state); });
    if constexpr (std::is_same_v<T, double>)
      return out;
    else
      return point(out);
  };
}

void require_environment(const DeformingSolid& self, const geo::Environment& e) {
  const auto n = self.solid.size();
  const auto require = [&](const char* name, std::size_t size) {
    if (size != 0 && size != n)
      throw geo::InputError(std::string("environment: ") + name + " has " + std::to_string(size) +
                            " values, the solid " + std::to_string(n) + " nodes");
  };
  require("fixed", e.fixed.size());
  require("load", e.load.size());
}

geo::ImplicitScheme scheme_named(const std::string& name) {
  if (name == "backward_euler") return geo::ImplicitScheme::backward_euler;
  if (name == "bossak") return geo::ImplicitScheme::bossak;
  throw geo::InputError("scheme: must be 'backward_euler' or 'bossak'");
}

// Without a scheme: an explicit step.
geo::StepReport step(DeformingSolid& self, State& state, double dt, const geo::Environment& environment,
                     double accuracy, std::optional<geo::ImplicitScheme> scheme) {
  const Writing writing(self.busy), moving(state.busy);
  require_fit(self, state);
  require_environment(self, environment);
  if (!(dt > 0) || !std::isfinite(dt)) throw geo::InputError("dt: give a positive number of seconds");
  if (!(accuracy > 0 && accuracy <= 1)) throw geo::InputError("accuracy: give a number above 0 and up to 1");
  state.changed();
  return without_gil([&] {
    return scheme ? self.solid.step_implicit(state.state, dt, environment, accuracy, geo::Division::allowed, *scheme)
                  : self.solid.step_explicit(state.state, dt, environment);
  });
}

py::array material_displacement(DeformingSolid& self, const Graph& graph, State& state) {
  const Reading reading(self.busy), still(state.busy);
  require_fit(self, state);
  if (graph.graph.node_count() != self.solid.size()) throw geo::InputError("graph: belongs to other nodes");
  return moved_points(
      without_gil([&] { return geo::material_displacement(self.solid, *graph.nodes, graph.graph, state.state); }));
}

py::array von_mises(DeformingSolid& self, const NodeSet& nodes, State& state) {
  const Reading reading(self.busy), still(state.busy);
  require_fit(self, state);
  if (nodes.nodes->size() != self.solid.size()) throw geo::InputError("nodes: are others than the solid's");
  return moved<double>(without_gil([&] { return geo::von_mises_stress(self.solid, *nodes.nodes, state.state); }));
}

}  // namespace

void add_fields(Solids& solid) {
  solid
      .def(
          "gradients",
          [](DeformingSolid& self, py::object u) {
            const Reading reading(self.busy);
            const auto values = displacements(self, u);
            return moved_matrices(without_gil([&] { return self.solid.gradients(values); }));
          },
          py::arg("u"), "Gradient of the displacements u, (n, 3) or a State, at every node: (n, 3, 3). InputError.")
      .def("gradient_stencil", &stencil, py::arg("node"),
           "Nodes j, (s,) uint32, and vectors g_j, (s, 3), 1/m, with gradient = sum of u_j g_j^T at this node.")
      .def(
          "energy",
          [](DeformingSolid& self, py::object u) {
            const Reading reading(self.busy);
            const geo::State state = state_of(self, u);
            return without_gil([&] { return self.solid.energy(state); });
          },
          py::arg("u"),
          "Elastic energy at displacements u, (n, 3), or of a State with its plastic strain and prestretch; J. Raises\n"
          "InputError.")
      .def(
          "forces",
          [](DeformingSolid& self, py::object u) {
            const Reading reading(self.busy);
            const geo::State state = state_of(self, u);
            return moved_points(without_gil([&] { return self.solid.forces(state); }));
          },
          py::arg("u"),
          "Elastic forces at displacements u, (n, 3), or of a State with its plastic strain and prestretch; (n, 3), "
          "N.\n"
          "They sum to zero.")
      .def(
          "stiffness_product",
          [](DeformingSolid& self, py::object u, py::object p) {
            const Reading reading(self.busy);
            const auto values = displacements(self, u);
            const auto direction = vectors_from(p, "p", self.solid.size());
            return moved_points(without_gil([&] { return self.solid.stiffness_product(values, direction); }));
          },
          py::arg("u"), py::arg("p"),
          "Stiffness of the implicit step at u times p, (n, 3), N; in single precision, negative eigenvalues left out.")
      .def("stress_at", &stress_at, py::arg("state"), py::arg("x"), py::arg("radius"), py::arg("sees") = py::none(),
           "Cauchy stress about material position x, (3, 3), Pa: mean over the material points within radius. sees: a\n"
           "callable of a position that accepts the points that count. Raises InputError.")
      .def("momentum", total(&geo::Solid::momentum), py::arg("state"), "Linear momentum, (3,), kg m/s.")
      .def("angular_momentum", total(&geo::Solid::angular_momentum), py::arg("state"),
           "Angular momentum about the world's origin, (3,), kg m2/s.")
      .def("kinetic_energy", total(&geo::Solid::kinetic_energy), py::arg("state"), "Kinetic energy, J.");
}

void add_steps(Solids& solid) {
  solid
      .def(
          "step_implicit",
          [](DeformingSolid& self, State& state, double dt, const geo::Environment& environment, double accuracy,
             const std::string& scheme) { return step(self, state, dt, environment, accuracy, scheme_named(scheme)); },
          py::arg("state"), py::arg("dt"), py::arg("environment"), py::arg("accuracy") = 1e-3,
          py::arg("scheme") = "backward_euler",
          "Advances state by dt seconds. accuracy: of displacements, relative to the spacing of nodes. scheme:\n"
          "'backward_euler', or 'bossak', of second order where nothing touches. Returns a StepReport. Raises "
          "InputError.")
      .def(
          "step_explicit",
          [](DeformingSolid& self, State& state, double dt, const geo::Environment& environment) {
            return step(self, state, dt, environment, 1e-3, std::nullopt);
          },
          py::arg("state"), py::arg("dt"), py::arg("environment"),
          "Advances state by dt seconds with symplectic Euler, in as many substeps as the fastest wave requires.\n"
          "Returns a StepReport. Raises InputError.");
}

void bind_solid_fields(py::module_& module) {
  py::class_<geo::StepReport>(module, "StepReport", "Work and result of one time step.")
      .def_readonly("newton", &geo::StepReport::newton, "Newton iterations.")
      .def_readonly("cg", &geo::StepReport::cg, "Iterations of conjugate gradients.")
      .def_readonly("substeps", &geo::StepReport::substeps, "Time steps that the step was divided into.")
      .def_readonly("energy", &geo::StepReport::energy, "Elastic energy after the step, J.");
  module.def("material_displacement", &material_displacement, py::arg("solid"), py::arg("graph"), py::arg("state"),
             "Displacement of the material at each node, (n, 3): Eq. 1 over the node and its neighbours. A node's own\n"
             "displacement is a coefficient of that field. Raises InputError.");
  module.def("von_mises_stress", &von_mises, py::arg("solid"), py::arg("nodes"), py::arg("state"),
             "Von Mises equivalent of the Cauchy stress at each node, (n,) float64, Pa. Raises InputError.");
}

}  // namespace kerf_python
