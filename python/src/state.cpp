// State and Environment.
#include <algorithm>
#include <cmath>

#include "bind.h"
#include "kerf/error.h"
#include "keywords.h"
#include "material.h"
#include "solid.h"

namespace kerf_python {
namespace {

using Vectors = std::vector<geo::Vec3>;

std::shared_ptr<State> made(py::object displacement, py::object velocity, py::object acceleration, py::object plastic,
                            py::object prestretch) {
  geo::State state;
  state.displacement = points_from(displacement, "displacement");
  const auto n = state.displacement.size();
  state.velocity = velocity.is_none() ? Vectors(n, geo::Vec3::Zero()) : vectors_from(velocity, "velocity", n);
  if (!acceleration.is_none()) state.acceleration = vectors_from(acceleration, "acceleration", n);
  if (!plastic.is_none()) state.plastic = matrices_from(plastic, "plastic");
  if (!prestretch.is_none()) state.prestretch = matrices_from(prestretch, "prestretch");
  return std::make_shared<State>(std::move(state));
}

// A property with one vector per node; a kept copy is handed out until the state changes.
void vectors(py::class_<State, std::shared_ptr<State>>& state, const char* name, Vectors geo::State::*member,
             py::object State::*kept, const char* doc) {
  state.def_property(
      name,
      [member, kept](State& self) -> py::object {
        const Reading reading(self.busy);
        if ((self.state.*member).empty() && member == &geo::State::acceleration) return py::none();
        if (!(self.*kept)) self.*kept = moved_points(Vectors(self.state.*member));
        return self.*kept;
      },
      [name, member](State& self, py::object value) {
        const Writing writing(self.busy);
        const bool none = value.is_none() && member == &geo::State::acceleration;
        self.state.*member = none ? Vectors() : vectors_from(value, name, self.state.displacement.size());
        self.changed();
      },
      doc);
}

// A property, not to be assigned, with one matrix per material point; None where there are none.
void matrices(py::class_<State, std::shared_ptr<State>>& state, const char* name,
              std::vector<geo::Mat3> geo::State::*member, py::object State::*kept, const char* doc) {
  state.def_property_readonly(
      name,
      [member, kept](State& self) -> py::object {
        const Reading reading(self.busy);
        if ((self.state.*member).empty()) return py::none();
        if (!(self.*kept)) self.*kept = moved_matrices(self.state.*member);
        return self.*kept;
      },
      doc);
}

geo::Environment environment_from(const py::kwargs& given) {
  Keywords k(given, "Environment");
  geo::Environment e;
  const auto vector = [&](const char* name, geo::Vec3& out) {
    const auto value = k.object(name);
    if (!value.is_none()) out = point_from(value, name);
  };
  vector("gravity", e.gravity);
  for (const char* gone : {"ground", "ground_point", "ground_normal", "ground_stiffness", "friction", "clearance"})
    if (!k.object(gone).is_none())
      throw geo::InputError(std::string(gone) + ": an Environment has no ground; give the [ground] of a Scene");
  const auto fixed = k.object("fixed"), load = k.object("load");
  if (!load.is_none()) e.load = points_from(load, "load");
  if (!fixed.is_none()) {
    auto array = py::array::ensure(fixed);
    if (!array) PyErr_Clear();
    const bool truth = array && array.dtype().kind() == 'b';
    const auto values = integers_from(truth ? py::object(array.attr("astype")("int64")) : fixed, "fixed", 0, 1);
    e.fixed.assign(values.begin(), values.end());
  }
  k.finish();
  return e;
}

constexpr const char* environment_doc =
    "External actions on the nodes during a time step. It never changes.\n\n"
    "Environment(*, gravity=(0, 0, -9.81), fixed: (n,) truth values, True clamps a node, load: (n, 3) forces, N).\n"
    "Contact needs a surface: the ground and obstacles are those of a Scene. Raises InputError.";

}  // namespace

std::vector<geo::Vec3> vectors_from(py::handle object, const std::string& name, std::size_t nodes) {
  auto out = points_from(object, name);
  if (out.size() != nodes)
    throw geo::InputError(name + ": " + std::to_string(out.size()) + " rows for " + std::to_string(nodes) +
                          " nodes; give one per node");
  return out;
}

void bind_state(py::module_& module) {
  py::class_<State, std::shared_ptr<State>> state(
      module, "State",
      "The motion of a solid at one instant. Arrays are snapshots; assign whole arrays to change it.\n\n"
      "State(displacement, velocity=None, acceleration=None, plastic=None, prestretch=None): (n, 3) model units and "
      "model units per\n"
      "second, per node; (points, 3, 3) plastic Green strain and prestretch per material point. Raises InputError.");
  state.def(py::init(&made), py::arg("displacement"), py::arg("velocity") = py::none(),
            py::arg("acceleration") = py::none(), py::arg("plastic") = py::none(), py::arg("prestretch") = py::none(),
            "See the class.");
  vectors(state, "displacement", &geo::State::displacement, &State::displacement, "(n, 3) float64, model units.");
  vectors(state, "velocity", &geo::State::velocity, &State::velocity, "(n, 3) float64, model units per second.");
  vectors(state, "acceleration", &geo::State::acceleration, &State::acceleration,
          "(n, 3) float64 of the last time step, for the inertial predictor; None: unknown.");
  matrices(state, "plastic", &geo::State::plastic, &State::plastic,
           "(points, 3, 3) float64: plastic part of the Green strain per material point; None: none yet.");
  matrices(state, "prestretch", &geo::State::prestretch, &State::prestretch,
           "(points, 3, 3) float64: symmetric stretch of the material at rest from its state without stress, per\n"
           "material point; None: none.");
  state
      .def(
          "copy",
          [](State& self) {
            const Reading reading(self.busy);
            return std::make_shared<State>(self.state);
          },
          "A copy that changes on its own.")
      .def("__len__", [](State& self) { return self.state.displacement.size(); });
  py::class_<geo::Environment>(module, "Environment", environment_doc)
      .def(py::init(&environment_from), "See the class.")
      .def_property_readonly(
          "gravity", [](const geo::Environment& e) { return point(e.gravity); }, "Acceleration, (3,), m/s2.");
}

}  // namespace kerf_python
