// Undo keeps the states of the fronts that a call changes. The library keeps one edit only, so that
// calls of several edits cannot be undone.
#include "complex.h"

#include <pybind11/stl.h>

#include <algorithm>

#include "bind.h"
#include "kerf/check.h"
#include "kerf/error.h"

namespace kerf_python {

Complex::Complex(geo::Complex made, std::shared_ptr<Mesh> original)
    : complex(std::move(made)), model(std::move(original)) {}

Complex::Complex(const Complex& other) : complex(other.complex), model(other.model), found_(other.found_) {
  for (const auto& front : other.fronts) fronts.push_back(std::make_shared<FrontRecord>(*front));
}

void Complex::undo() {
  const Writing writing(busy);
  if (!undo_.possible)
    throw geo::GeometryError("undo: the last call made many edits, or there is none; work on a copy()");
  found_.reset();
  if (undo_.changed) complex.undo();
  for (const auto& [front, before] : undo_.fronts) *front = before;
  undo_ = {};
}

std::shared_ptr<const geo::Pieces> Complex::found() {
  if (!found_) found_ = without_gil([&] { return std::make_shared<const geo::Pieces>(geo::find_pieces(complex)); });
  return found_;
}

geo::TriangleMesh Complex::surface() const {
  geo::TriangleMesh mesh = complex.two_sided();
  if (model) geo::transfer_attributes(model->mesh, mesh);
  return mesh;
}

std::int32_t Complex::next_crack() const {
  geo::CrackNumbers numbers(complex);
  for (const auto& front : fronts) numbers.note(front->state.crack);
  return numbers.next();
}

std::vector<geo::FrontState*> Complex::states() const {
  std::vector<geo::FrontState*> out;
  for (const auto& front : fronts) out.push_back(&front->state);
  return out;
}

std::shared_ptr<Complex> complex_of(std::shared_ptr<Mesh> surface) {
  auto made = without_gil([&] { return geo::Complex::from_two_sided(surface->mesh); });
  return std::make_shared<Complex>(std::move(made), std::move(surface));
}

std::shared_ptr<Complex> uncut_complex(const std::shared_ptr<Mesh>& mesh) {
  const auto model = model_of(mesh);
  const auto uncut = model->uncut();
  return without_gil([&] { return std::make_shared<Complex>(geo::Complex(*uncut), model); });
}

ModelReading::ModelReading(py::handle object, const std::string& name) {
  if (py::isinstance<Complex>(object)) {
    cut_ = object.cast<std::shared_ptr<Complex>>();
    reading_ = std::make_unique<Reading>(cut_->busy);
    return;
  }
  uncut_ = model_of(mesh_argument(object, name))->uncut();
}

namespace {

void add_state(py::class_<Complex, std::shared_ptr<Complex>>& complex) {
  complex
      .def_property_readonly(
          "model", [](const Complex& self) { return self.model; },
          "The surface that the complex was made of, a Mesh, or None.")
      .def_property_readonly(
          "vertex_count", [](const Complex& self) { return self.complex.vertex_count(); },
          "Number of vertices, those without faces included.")
      .def_property_readonly(
          "face_count", [](const Complex& self) { return self.complex.face_count(); },
          "Number of ids of faces, dead ones included.")
      .def_property_readonly(
          "live_face_count", [](const Complex& self) { return self.complex.live_face_count(); },
          "Number of living faces.")
      .def_property_readonly(
          "crack_count", [](const Complex& self) { return self.complex.crack_count(); },
          "The largest number of a crack.")
      .def_property_readonly(
          "extent",
          [](const Complex& self) {
            const auto& box = self.complex.extent();
            return moved_points(std::vector<geo::Vec3>{box.lo, box.hi});
          },
          "Lowest and highest corner of the box around the skin as first given, (2, 3) float64. It never changes;\n"
          "tolerances are relative to its diagonal.")
      .def_property_readonly(
          "diagonal", [](const Complex& self) { return self.complex.extent().diagonal(); },
          "Length of the diagonal of extent, model units.");
}

void add_calls(py::class_<Complex, std::shared_ptr<Complex>>& complex) {
  complex
      .def(
          "surface",
          [](Complex& self) {
            const Reading reading(self.busy);
            return std::make_shared<Mesh>(without_gil([&] { return self.surface(); }));
          },
          "The two-sided surface with the attributes of the model, as a Mesh with patch, site and source: every face\n"
          "of the skin once, every face of a crack twice. Closed, oriented, manifold (§ 5.1).")
      .def(
          "copy",
          [](Complex& self) {
            const Reading reading(self.busy);
            return std::make_shared<Complex>(self);
          },
          "An independent copy, with copies of the fronts.")
      .def("__copy__",
           [](Complex& self) {
             const Reading reading(self.busy);
             return std::make_shared<Complex>(self);
           })
      .def(
          "__deepcopy__",
          [](Complex& self, const py::object&) {
            const Reading reading(self.busy);
            return std::make_shared<Complex>(self);
          },
          py::arg("memo"))
      .def(
          "undo", &Complex::undo,
          "Reverts the last insert(), advance() or apply(): complex and fronts are as before it, down to the ids that\n"
          "the next edit assigns. Only one call can be reverted, and none of remesh(), roughen() and decimate().\n"
          "Raises GeometryError where there is nothing to revert.")
      .def(
          "apply",
          [](Complex& self, const geo::ComplexEdit& edit) {
            for (const auto& face : edit.new_faces)
              if (face.parent.valid() && face.parent.value >= self.complex.face_count())
                throw geo::InputError("apply: a parent is no face of the complex");
            return self.edit({}, true, [&] { return self.complex.apply(edit); });
          },
          py::arg("edit"),
          "Applies a ComplexEdit: all or nothing; returns the CrackDelta. Cost follows the edit. Raises "
          "GeometryError,\n"
          "the complex unchanged, for an edit that breaks a structural rule. Positions are not tested: see check().")
      .def(
          "difference",
          [](Complex& self, Complex& other) {
            const Reading reading(self.busy), other_reading(other.busy);
            return without_gil([&] { return self.complex.difference(other.complex); });
          },
          py::arg("other"),
          "The ComplexEdit that turns this complex into `other`, which must have grown from it. Raises InputError\n"
          "where it has not.")
      .def("__repr__", [](const Complex& self) {
        return "<kerf.Complex of " + std::to_string(self.complex.live_face_count()) + " faces and " +
               std::to_string(self.complex.crack_count()) + " cracks>";
      });
}

}  // namespace

void bind_complex(py::module_& module) {
  py::class_<Complex, std::shared_ptr<Complex>> complex(
      module, "Complex",
      "A cracked model: the crack complex K of § 5.1, every face of skin and cracks stored once, with the two-sided\n"
      "surface derived from it. It changes by its methods; arrays that it gives are snapshots.\n\n"
      "Complex(surface): of a closed Mesh, or of a two-sided one as surface() gives it. Raises InputError where the\n"
      "surface is open, not manifold, inside out or its sides do not pair up. Self-intersection is not tested: see\n"
      "check(); Solid(...).complex() is always valid.");
  complex.def(py::init([](const py::object& surface) { return complex_of(mesh_argument(surface, "surface")); }),
              py::arg("surface"), "See the class.");
  add_state(complex);
  add_calls(complex);

  py::class_<Mesh, std::shared_ptr<Mesh>>(module.attr("Mesh"))
      .def(
          "complex", [](const std::shared_ptr<Mesh>& self) { return uncut_complex(self); },
          "The crack complex of the model, without cracks (§ 5.1). Raises InputError where the mesh is no valid "
          "model.");
}

}  // namespace kerf_python
