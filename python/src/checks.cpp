// Validity of meshes and complexes, and the exact predicates behind it.
#include "checks.h"

#include <pybind11/stl.h>

#include <algorithm>

#include "apart.h"
#include "bind.h"
#include "complex.h"
#include "kerf/contact.h"
#include "kerf/crack.h"
#include "kerf/error.h"

namespace kerf_python {

std::size_t collapsed_triangles(const geo::TriangleMesh& mesh) {
  return static_cast<std::size_t>(std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [](const auto& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
  }));
}

namespace {

std::array<geo::Vec3, 3> triangle_from(const py::object& corners, const char* name) {
  const auto points = points_from(corners, name);
  if (points.size() != 3) throw geo::InputError(std::string(name) + ": give three points");
  return {points[0], points[1], points[2]};
}

std::array<std::uint32_t, 3> ids_of_triangle(const py::object& ids, const char* name) {
  const auto values = integers_from(ids, name, 0, 0xffffffffLL);
  if (values.size() != 3) throw geo::InputError(std::string(name) + ": give three ids");
  std::array<std::uint32_t, 3> out;
  std::transform(values.begin(), values.end(), out.begin(), [](auto v) { return static_cast<std::uint32_t>(v); });
  return out;
}

geo::SelfIntersections tested(bool crossings) {
  return crossings ? geo::SelfIntersections::find : geo::SelfIntersections::ignore;
}

// A mesh whose crossings can be counted.
const geo::TriangleMesh& countable(const Mesh& mesh) {
  if (collapsed_triangles(mesh.mesh) > 0)
    throw geo::InputError("crossings: a triangle has a vertex twice; remove it, or repair the mesh");
  return mesh.mesh;
}

py::list shells_of(const geo::SurfaceReport& report) {
  static constexpr const char* kinds[] = {"outer", "cavity", "inverted", "hidden"};
  py::list out;
  for (const geo::Shell& shell : report.shells) {
    py::dict one;
    one["kind"] = kinds[static_cast<int>(shell.kind)];
    one["first_face"] = shell.first_triangle;
    one["faces"] = shell.triangles;
    one["parent"] = shell.parent == ~0u ? py::object(py::none()) : py::object(py::int_(shell.parent));
    one["depth"] = shell.depth;
    out.append(one);
  }
  return out;
}

void bind_report(py::module_& module) {
  using Report = geo::SurfaceReport;
  py::class_<Report>(module, "SurfaceReport", "Outcome of a check of a mesh or a complex. True where it is valid.")
      .def_readonly("closed", &Report::closed, "No edge has one triangle.")
      .def_readonly("manifold", &Report::manifold, "No edge has more than two triangles.")
      .def_readonly("oriented", &Report::oriented, "The triangles of each edge run along it in opposite directions.")
      .def_readonly("degenerate_faces", &Report::degenerate_faces, "Number of faces of zero area, exactly.")
      .def_readonly("self_intersections", &Report::self_intersections,
                    "Number of pairs of faces that intersect; None: not tested.")
      .def_property_readonly("shells", &shells_of,
                             "The connected parts of the skin, by their first faces, each a dict: kind, 'outer' or "
                             "'cavity', or,\n"
                             "oriented wrongly, 'inverted' or 'hidden'; first_face; faces; parent, the index of the\n"
                             "innermost shell around it, or None; depth. Empty where the mesh has another fault, or\n"
                             "crossings were not tested.")
      .def_readonly("first_problem", &Report::first_problem, "Names indices; empty for a valid surface.")
      .def_property_readonly("good", &Report::good, "Whether there is no problem.")
      .def("__bool__", &Report::good, "Whether there is no problem.")
      .def("__repr__", [](const Report& self) {
        return "<kerf.SurfaceReport: " + (self.good() ? std::string("valid") : self.first_problem) + ">";
      });
}

void add_to_classes(py::module_& module) {
  py::class_<Mesh, std::shared_ptr<Mesh>>(module.attr("Mesh"))
      .def(
          "check",
          [](const std::shared_ptr<Mesh>& self, bool crossings) {
            return stoppable("check", [self, how = tested(crossings)](const geo::Progress&) {
              return geo::check_surface(self->mesh, how);
            });
          },
          py::arg("self_intersections") = true,
          "Checks that the mesh is closed, manifold, oriented and without degenerate or intersecting triangles; "
          "exact.\n"
          "A two-sided surface is checked as a crack complex. Returns a SurfaceReport.")
      .def(
          "crossings",
          [](const std::shared_ptr<Mesh>& self) {
            return stoppable("crossings",
                             [self](const geo::Progress&) { return geo::count_crossings(countable(*self)); });
          },
          "Number of pairs of triangles that cross: have a common point other than shared vertices and edges. On a\n"
          "two-sided surface, copies of a site at one place count as one vertex. Exact. Raises InputError where a\n"
          "triangle has a vertex twice.");
  py::class_<Complex, std::shared_ptr<Complex>>(module.attr("Complex"))
      .def(
          "check",
          [](Complex& self, bool crossings) {
            const Reading reading(self.busy);
            return without_gil([&] { return geo::check_complex(self.complex, tested(crossings)); });
          },
          py::arg("self_intersections") = true,
          "Checks that radial cycles are in geometric order, wedges are all material or all air, the two-sided "
          "surface\n"
          "is closed, oriented and manifold, no face is degenerate, and no two faces intersect. Exact. Returns a\n"
          "SurfaceReport.")
      .def(
          "check_near",
          [](Complex& self, const py::object& faces) {
            const Reading reading(self.busy);
            const auto ids = ids_from<geo::FaceId>(faces, "faces", self.complex.face_count());
            return without_gil([&] { return geo::check_near(self.complex, ids); });
          },
          py::arg("faces"),
          "The structural part of check() for some faces, (k,) ids, and the faces that share a corner with them: a "
          "step\n"
          "with these new faces can break nothing else. Returns a SurfaceReport. Raises InputError for unknown ids.")
      .def(
          "self_intersections",
          [](Complex& self, const py::object& only) {
            const Reading reading(self.busy);
            std::vector<geo::FaceId> ids;
            if (!only.is_none()) ids = ids_from<geo::FaceId>(only, "only", self.complex.face_count());
            std::erase_if(ids, [&](geo::FaceId f) { return !self.complex.alive(f); });
            auto pairs =
                without_gil([&] { return geo::self_intersections(self.complex, only.is_none() ? nullptr : &ids); });
            return moved<std::uint32_t>(std::move(pairs), {2});
          },
          py::arg_v("only", py::none()),
          "Pairs of faces that meet other than in shared vertices and edges, (k, 2) uint32. only: (k,) ids of faces, "
          "of\n"
          "which a pair has one at least; dead ones are skipped. Exact. Raises InputError for unknown ids.");
}

void bind_predicates(py::module_& module) {
  module.def(
      "faces_cross",
      [](const py::object& f, const py::object& p, const py::object& g, const py::object& q) {
        return geo::faces_cross(ids_of_triangle(f, "f"), triangle_from(p, "p"), ids_of_triangle(g, "g"),
                                triangle_from(q, "q"));
      },
      py::arg("f"), py::arg("p"), py::arg("g"), py::arg("q"),
      "Whether two triangles, of vertex ids f and g, (3,), and points p and q, (3, 3), meet other than in vertices "
      "and\n"
      "edges shared by id. Exact. Raises InputError.");
  module.def(
      "in_radial_order",
      [](const py::object& a, const py::object& b, const py::object& through) {
        const auto from = point_from(a, "a"), to = point_from(b, "b");
        const auto points = points_from(through, "through");
        if (from == to) throw geo::InputError("in_radial_order: a and b are at one place");
        return geo::in_radial_order(from, to, points);
      },
      py::arg("a"), py::arg("b"), py::arg("through"),
      "Whether the half-planes from line ab through the points, (n, 3), are in radial order: counter-clockwise about "
      "a\n"
      "to b, each strictly after the one before it. Exact. Raises InputError.");
  module.def(
      "smallest_angle",
      [](const py::object& corners) { return geo::smallest_angle(triangle_from(corners, "corners")); },
      py::arg("corners"), "The smallest angle of a triangle, (3, 3) corners, in degrees. Raises InputError.");
  module.def(
      "face_normal",
      [](const py::object& corners) {
        const auto c = triangle_from(corners, "corners");
        return point(geo::face_normal(c[0], c[1], c[2]));
      },
      py::arg("corners"),
      "The unit normal of a triangle, (3, 3) corners, as (3,) float64; zero where it has no area. Raises InputError.");
}

// Counts under a guard: its cache is not for two threads.
struct Counter {
  geo::CrossingCounter counter;
  Busy busy;
};

void bind_counter(py::module_& module) {
  py::class_<Counter, std::shared_ptr<Counter>>(
      module, "CrossingCounter",
      "Counts the crossings of one surface after the other, such as the frames of a run. Faster than Mesh.crossings()\n"
      "where consecutive surfaces have the same triangles.")
      .def(py::init<>(), "A counter that has seen no surface.")
      .def(
          "count",
          [](Counter& self, const py::object& surface) {
            const auto mesh = mesh_argument(surface, "surface");
            countable(*mesh);
            const Writing writing(self.busy);
            return without_gil([&] { return self.counter.count(mesh->mesh); });
          },
          py::arg("surface"),
          "The number of pairs of triangles of a Mesh that cross, as Mesh.crossings(). Raises InputError where a "
          "triangle\n"
          "has a vertex twice.");
}

}  // namespace

void bind_checks(py::module_& module) {
  bind_report(module);
  add_to_classes(module);
  bind_predicates(module);
  bind_counter(module);
}

}  // namespace kerf_python
