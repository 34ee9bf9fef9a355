// Faces, vertices, radial cycles and sides of a Complex. Every id is checked, every array is a
// copy.
#include <pybind11/stl.h>

#include "bind.h"
#include "complex.h"
#include "kerf/error.h"

namespace kerf_python {
namespace {

using Class = py::class_<Complex, std::shared_ptr<Complex>>;

template <class Id>
Id id_from(std::int64_t value, std::size_t count, const char* name) {
  if (value < 0 || static_cast<std::uint64_t>(value) >= count)
    throw geo::InputError(std::string(name) + ": " + std::to_string(value) + " is out of range; there are " +
                          std::to_string(count));
  return Id(static_cast<std::uint32_t>(value));
}

geo::VertexId vertex(const Complex& self, std::int64_t v) {
  return id_from<geo::VertexId>(v, self.complex.vertex_count(), "vertex");
}

geo::FaceId face(const Complex& self, std::int64_t f) {
  return id_from<geo::FaceId>(f, self.complex.face_count(), "face");
}

geo::FaceId living_face(const Complex& self, std::int64_t f) {
  const auto id = face(self, f);
  if (!self.complex.alive(id)) throw geo::InputError("face: " + std::to_string(f) + " is dead; give a living one");
  return id;
}

geo::Side side(const Complex& self, std::int64_t f, int which) {
  const geo::Side s{living_face(self, f), which};
  if (which < 0 || which > 1 || !self.complex.has(s))
    throw geo::InputError("side: skin has side 0 only, a face of a crack sides 0 and 1");
  return s;
}

int corner(int k) {
  if (k < 0 || k > 2) throw geo::InputError("corner: give 0, 1 or 2");
  return k;
}

geo::SurfaceVertexId surface_vertex(const Complex& self, std::int64_t v) {
  const auto id = id_from<geo::SurfaceVertexId>(v, self.complex.surface_vertex_count(), "surface vertex");
  if (!self.complex.alive(id))
    throw geo::InputError("surface vertex: " + std::to_string(v) + " is dead; give a living one");
  return id;
}

// One value for each id of a face.
template <class T, class Get>
py::array per_face(Complex& self, std::vector<py::ssize_t> inner, const Get& get) {
  const Reading reading(self.busy);
  std::vector<T> out(self.complex.face_count());
  for (std::uint32_t f = 0; f < out.size(); ++f) out[f] = get(self.complex.face(geo::FaceId(f)));
  if constexpr (requires { out[0][0]; })
    return moved<std::uint32_t>(std::move(out), std::move(inner));
  else
    return moved<T>(std::move(out), std::move(inner));
}

void add_arrays(Class& complex) {
  using Face = geo::Complex::Face;
  complex
      .def_property_readonly(
          "points",
          [](Complex& self) {
            const Reading reading(self.busy);
            std::vector<geo::Vec3> out(self.complex.vertex_count());
            for (std::uint32_t v = 0; v < out.size(); ++v) out[v] = self.complex.point(geo::VertexId(v));
            return moved_points(std::move(out));
          },
          "Positions of all vertices, (vertex_count, 3) float64, material coordinates.")
      .def_property_readonly(
          "faces",
          [](Complex& self) {
            return per_face<std::array<geo::VertexId, 3>>(self, {3}, [](const Face& f) { return f.v; });
          },
          "Vertices of all faces, (face_count, 3) uint32; the rows of dead faces stay. Counter-clockwise from the "
          "side\n"
          "that the normal points to.")
      .def_property_readonly(
          "alive",
          [](Complex& self) {
            const Reading reading(self.busy);
            py::array_t<bool> out(static_cast<py::ssize_t>(self.complex.face_count()));
            auto values = out.mutable_unchecked<1>();
            for (std::uint32_t f = 0; f < self.complex.face_count(); ++f)
              values(f) = self.complex.alive(geo::FaceId(f));
            return out;
          },
          "Whether each face lives, (face_count,) bool.")
      .def_property_readonly(
          "face_cracks",
          [](Complex& self) { return per_face<std::int32_t>(self, {}, [](const Face& f) { return f.crack; }); },
          "Crack of each face, (face_count,) int32; 0: skin.")
      .def_property_readonly(
          "face_sources",
          [](Complex& self) { return per_face<std::uint32_t>(self, {}, [](const Face& f) { return f.source; }); },
          "Triangle of the model that contains each face, (face_count,) uint32; 2**32 - 1: none.");
}

void add_incidence(Class& complex) {
  complex
      .def(
          "corners",
          [](Complex& self, std::int64_t f) {
            const Reading reading(self.busy);
            const auto c = self.complex.corners(face(self, f));
            return moved_points(std::vector<geo::Vec3>(c.begin(), c.end()));
          },
          py::arg("face"), "Positions of a face's vertices, (3, 3) float64. Raises InputError for an unknown id.")
      .def(
          "box",
          [](Complex& self, std::int64_t f) {
            const Reading reading(self.busy);
            const auto& box = self.complex.box(living_face(self, f));
            return moved_points(std::vector<geo::Vec3>{box.lo, box.hi});
          },
          py::arg("face"), "Lowest and highest corner of a living face, (2, 3) float64. Raises InputError.")
      .def(
          "faces_around",
          [](Complex& self, std::int64_t a, std::int64_t b) {
            const Reading reading(self.busy);
            const auto cycle = self.complex.faces_around(vertex(self, a), vertex(self, b));
            return moved_ids(std::vector<geo::FaceId>(cycle.begin(), cycle.end()));
          },
          py::arg("a"), py::arg("b"),
          "The radial cycle of edge ab: its faces counter-clockwise about the edge from its lower to its higher "
          "vertex,\n"
          "(k,) uint32; empty where there is no such edge. Raises InputError for an unknown id.")
      .def(
          "faces_at",
          [](Complex& self, std::int64_t v) {
            const Reading reading(self.busy);
            std::vector<geo::FaceId> out;
            for (const auto f : self.complex.faces_at(vertex(self, v))) out.push_back(f);
            return moved_ids(std::move(out));
          },
          py::arg("vertex"), "The living faces at a vertex, ascending, (k,) uint32. Raises InputError.")
      .def(
          "faces_near",
          [](Complex& self, const py::object& lo, const py::object& hi) {
            const geo::Box3 box{point_from(lo, "lo"), point_from(hi, "hi")};
            const Reading reading(self.busy);
            std::vector<geo::FaceId> out;
            self.complex.faces_near(box, out);
            return moved_ids(std::move(out));
          },
          py::arg("lo"), py::arg("hi"),
          "The living faces whose boxes meet the box from lo to hi, ascending, (k,) uint32. Raises InputError.")
      .def(
          "faces_near_triangle",
          [](Complex& self, const py::object& corners, double reach) {
            const auto c = points_from(corners, "corners");
            if (c.size() != 3) throw geo::InputError("corners: give three points");
            if (!(reach >= 0 && reach <= geo::largest_coordinate))
              throw geo::InputError("reach: give a length of 0 or more");
            const Reading reading(self.busy);
            std::vector<geo::FaceId> out;
            self.complex.faces_near_triangle(c[0], c[1], c[2], reach, out);
            return moved_ids(std::move(out));
          },
          py::arg("corners"), py::arg("reach") = 0.0,
          "The living faces near a triangle, (3, 3) corners, ascending, (k,) uint32: their box meets the triangle's,\n"
          "grown by reach (model units), and they are not farther than reach from its plane. Raises InputError.")
      .def(
          "faces_on_segment",
          [](Complex& self, const py::object& p, const py::object& q) {
            const auto from = point_from(p, "p"), to = point_from(q, "q");
            const Reading reading(self.busy);
            return moved_ids(without_gil([&] { return geo::faces_on_segment(self.complex, from, to); }));
          },
          py::arg("p"), py::arg("q"),
          "The living faces that the closed segment pq touches, ascending, (k,) uint32. Exact. Raises InputError.");
}

void add_sides(Class& complex) {
  complex
      .def(
          "has_side",
          [](Complex& self, std::int64_t f, int which) {
            const Reading reading(self.busy);
            return (which == 0 || which == 1) && self.complex.has({face(self, f), which});
          },
          py::arg("face"), py::arg("which"),
          "Whether a face has a side: 0, the material behind it, for every living face; 1, the material before it, "
          "for\n"
          "faces of cracks. Raises InputError for an unknown id.")
      .def(
          "neighbor",
          [](Complex& self, std::int64_t f, int which, int k) {
            const Reading reading(self.busy);
            const auto n = self.complex.neighbor(side(self, f, which), corner(k));
            return py::make_tuple(n.face.value, n.which);
          },
          py::arg("face"), py::arg("which"), py::arg("corner"),
          "The neighbour of a side on the two-sided surface, across the edge from the face's corner to the next one: "
          "a\n"
          "tuple (face, which). Raises InputError.")
      .def(
          "surface_vertex",
          [](Complex& self, std::int64_t f, int which, int k) {
            const Reading reading(self.busy);
            return self.complex.surface_vertex(side(self, f, which), corner(k)).value;
          },
          py::arg("face"), py::arg("which"), py::arg("corner"),
          "The vertex of the two-sided surface at a corner of a side. Raises InputError.")
      .def_property_readonly(
          "surface_vertex_count", [](const Complex& self) { return self.complex.surface_vertex_count(); },
          "Number of ids of vertices of the two-sided surface, dead ones included.")
      .def_property_readonly(
          "sites",
          [](Complex& self) {
            const Reading reading(self.busy);
            std::vector<geo::VertexId> out;
            for (std::uint32_t v = 0; v < self.complex.surface_vertex_count(); ++v)
              out.push_back(self.complex.site(geo::SurfaceVertexId(v)));
            return moved_ids(std::move(out));
          },
          "The vertex of the complex at which each vertex of the two-sided surface stands, (surface_vertex_count,)\n"
          "uint32; 2**32 - 1 for dead ones. Living ones, in order, are the vertices of surface().")
      .def(
          "corner_of",
          [](Complex& self, std::int64_t v) {
            const Reading reading(self.busy);
            const auto [at, k] = self.complex.corner_of(surface_vertex(self, v));
            return py::make_tuple(at.face.value, at.which, k);
          },
          py::arg("surface_vertex"),
          "A corner (face, which, corner) of a living vertex of the two-sided surface. Raises InputError.")
      .def(
          "surface_neighbors",
          [](Complex& self, std::int64_t v) {
            const Reading reading(self.busy);
            std::vector<geo::SurfaceVertexId> out;
            self.complex.surface_neighbors(surface_vertex(self, v), out);
            return moved_ids(std::move(out));
          },
          py::arg("surface_vertex"),
          "The vertices one edge away on the two-sided surface, ascending, (k,) uint32. No such edge passes through a\n"
          "crack. Raises InputError.");
}

}  // namespace

void bind_complex_queries(py::module_& module) {
  Class complex(module.attr("Complex"));
  add_arrays(complex);
  add_incidence(complex);
  add_sides(complex);
}

}  // namespace kerf_python
