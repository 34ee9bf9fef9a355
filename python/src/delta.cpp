// CrackDelta and ComplexEdit. Their arrays are views whose base is the object itself.
#include "delta.h"

#include <pybind11/stl.h>

#include <algorithm>

#include "bind.h"
#include "kerf/error.h"

namespace kerf_python {
namespace {

using Size = py::ssize_t;

template <class Id>
py::array ids_of(const py::object& self, const std::vector<Id>& ids) {
  return view<std::uint32_t>(ids.data(), {static_cast<Size>(ids.size())}, self);
}

template <class Member>
auto ids_getter(Member member) {
  return [member](const py::object& self) { return ids_of(self, self.cast<const Delta&>().delta.*member); };
}

void bind_delta(py::module_& module) {
  using D = geo::CrackDelta;
  py::class_<Delta, std::shared_ptr<Delta>>(
      module, "CrackDelta",
      "The changes that an edit made to a crack complex: everything that a graph, a binding or a viewer needs to\n"
      "update incrementally (§ 5.2). All arrays are (n,) uint32, read-only views.")
      .def_property_readonly("new_vertices", ids_getter(&D::new_vertices), "Vertices of the complex that were added.")
      .def_property_readonly("removed_faces", ids_getter(&D::removed_faces), "Faces that were removed, now dead.")
      .def_property_readonly("new_faces", ids_getter(&D::new_faces), "Children of divided faces, and crack faces.")
      .def_property_readonly("new_crack_faces", ids_getter(&D::new_crack_faces),
                             "Crack faces that are no child of an earlier face.")
      .def_property_readonly("removed_surface_vertices", ids_getter(&D::removed_surface_vertices),
                             "Vertices of the two-sided surface that were removed.")
      .def_property_readonly("new_surface_vertices", ids_getter(&D::new_surface_vertices),
                             "Vertices of the two-sided surface that were added.")
      .def_property_readonly("touched_surface_vertices", ids_getter(&D::touched_surface_vertices),
                             "Vertices of the two-sided surface that stayed and whose triangles changed.")
      .def_property_readonly("copied_from", ids_getter(&D::copied_from),
                             "For each of new_surface_vertices the one at whose site it appeared; 2**32 - 1: a new\n"
                             "site.")
      .def_property_readonly(
          "stats", [](const Delta& self) { return py::dict(self.stats.attr("copy")()); },
          "Counts and seconds of the call, a dict with the names of the C++ structure.")
      .def(
          "__bool__", [](const Delta& self) { return !self.delta.empty(); }, "Whether a face changed.")
      .def("__repr__", [](const Delta& self) {
        return "<kerf.CrackDelta: " + std::to_string(self.delta.removed_faces.size()) + " faces removed, " +
               std::to_string(self.delta.new_faces.size()) + " added, " +
               std::to_string(self.delta.new_crack_faces.size()) + " of the crack>";
      });
}

geo::ComplexEdit edit_from(const py::object& vertices, const py::object& removed, const py::object& faces,
                           const py::object& cracks, const py::object& parents, const py::object& orders) {
  constexpr std::size_t any = std::size_t(1) << 32;
  geo::ComplexEdit edit;
  if (!vertices.is_none()) edit.new_vertices = points_from(vertices, "new_vertices");
  if (!removed.is_none()) edit.removed_faces = ids_from<geo::FaceId>(removed, "removed_faces", any);
  if (!faces.is_none())
    for (const auto& f : triangles_from(faces, "new_faces", any)) {
      geo::ComplexEdit::NewFace face;
      for (std::size_t k = 0; k < 3; ++k) face.v[k] = geo::VertexId(f[k]);
      edit.new_faces.push_back(face);
    }
  const auto each = [&](const py::object& values, const char* name, std::int64_t greatest, const auto& set) {
    if (values.is_none()) return;
    const auto numbers = integers_from(values, name, 0, greatest);
    if (numbers.size() != edit.new_faces.size())
      throw geo::InputError(std::string(name) + ": give one for each of new_faces");
    for (std::size_t i = 0; i < numbers.size(); ++i) set(edit.new_faces[i], numbers[i]);
  };
  each(cracks, "cracks", 1 << 30, [](auto& face, std::int64_t c) { face.crack = static_cast<std::int32_t>(c); });
  each(parents, "parents", 0xffffffffLL,
       [](auto& face, std::int64_t p) { face.parent = geo::FaceId(static_cast<std::uint32_t>(p)); });
  if (orders.is_none()) return edit;
  for (const auto item : orders) {
    if (!py::isinstance<py::sequence>(item) || py::len(item) != 3)
      throw geo::InputError("radial_orders: give triples of vertex a, vertex b and the faces around the edge");
    const auto triple = py::reinterpret_borrow<py::sequence>(item);
    const auto ends = ids_from<geo::VertexId>(py::make_tuple(triple[0], triple[1]), "radial_orders", any);
    edit.radial_orders.push_back({ends[0], ends[1], ids_from<geo::FaceId>(triple[2], "radial_orders", any)});
  }
  return edit;
}

// One value for each new face.
template <class T, class Get>
py::array per_new_face(const geo::ComplexEdit& edit, const Get& get) {
  std::vector<T> out;
  for (const auto& face : edit.new_faces) out.push_back(get(face));
  return moved<T>(std::move(out));
}

void bind_edit(py::module_& module) {
  using E = geo::ComplexEdit;
  const auto none = [](const char* name) { return py::arg_v(name, py::none()); };
  py::class_<E, std::shared_ptr<E>>(
      module, "ComplexEdit",
      "Changes that Complex.apply() makes at once. Ids refer to the complex as it is before; the i-th new vertex has\n"
      "the id vertex_count + i, the i-th new face face_count + i. Arrays are copies.")
      .def(
          py::init(&edit_from), py::kw_only(), none("new_vertices"), none("removed_faces"), none("new_faces"),
          none("cracks"), none("parents"), none("radial_orders"),
          "new_vertices: (n, 3) numbers. removed_faces: (r,) ids. new_faces: (m, 3) vertex ids. cracks: (m,) "
          "integers,\n"
          "0 for skin. parents: (m,) ids of removed faces that contain the new ones, or 2**32 - 1. radial_orders: for\n"
          "each edge that has three or more faces afterwards and gains or loses one, a triple of vertex a, vertex b "
          "and\n"
          "the ids of the faces around it, counter-clockwise about a to b. Raises InputError.")
      .def_property_readonly(
          "new_vertices", [](const E& self) { return moved_points(std::vector<geo::Vec3>(self.new_vertices)); },
          "Positions of added vertices, (n, 3) float64.")
      .def_property_readonly(
          "removed_faces", [](const E& self) { return moved_ids(std::vector<geo::FaceId>(self.removed_faces)); },
          "Ids of removed faces, (r,) uint32.")
      .def_property_readonly(
          "new_faces",
          [](const E& self) {
            std::vector<std::array<geo::VertexId, 3>> out;
            for (const auto& face : self.new_faces) out.push_back(face.v);
            return moved<std::uint32_t>(std::move(out), {3});
          },
          "Vertices of added faces, (m, 3) uint32.")
      .def_property_readonly(
          "cracks", [](const E& self) { return per_new_face<std::int32_t>(self, [](auto& f) { return f.crack; }); },
          "Crack of each added face, (m,) int32; 0: skin.")
      .def_property_readonly(
          "parents",
          [](const E& self) { return per_new_face<std::uint32_t>(self, [](auto& f) { return f.parent.value; }); },
          "The removed face that contains each added one, (m,) uint32; 2**32 - 1: none.")
      .def_property_readonly(
          "radial_orders",
          [](const E& self) {
            py::list out;
            for (const auto& order : self.radial_orders)
              out.append(
                  py::make_tuple(order.a.value, order.b.value, moved_ids(std::vector<geo::FaceId>(order.faces))));
            return out;
          },
          "The faces around edges of three or more faces: a list of (a, b, faces).")
      .def(
          "__bool__", [](const E& self) { return !self.empty(); }, "Whether the edit changes anything.");
}

}  // namespace

void bind_deltas(py::module_& module) {
  bind_delta(module);
  bind_edit(module);
}

}  // namespace kerf_python
