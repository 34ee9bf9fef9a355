// Methods of meshes: measures by face, repair, refinement, wrapping, hulls, attributes.
#include <pybind11/stl.h>

#include <cmath>

#include "apart.h"
#include "arguments.h"
#include "bind.h"
#include "busy.h"
#include "checks.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/pieces.h"
#include "kerf/repair.h"
#include "mesh.h"
#include "progress.h"

namespace kerf_python {
namespace {

using Shared = std::shared_ptr<Mesh>;

const geo::TriangleMesh& plain(const Mesh& mesh, const char* call) {
  if (mesh.mesh.two_sided())
    throw geo::InputError(std::string(call) + ": the mesh is two-sided; give the model before the cut");
  return mesh.mesh;
}

geo::InnerShells inner_from(const std::string& name, const char* call) {
  if (name == "oriented") return geo::InnerShells::by_orientation;
  if (name == "cavities") return geo::InnerShells::cavities;
  if (name == "filled") return geo::InnerShells::filled;
  throw geo::InputError(std::string(call) + ": inner must be 'oriented', 'cavities' or 'filled'");
}

geo::OpenParts open_from(const std::string& name) {
  if (name == "auto") return geo::OpenParts::by_area;
  if (name == "closed") return geo::OpenParts::closed;
  if (name == "sheets") return geo::OpenParts::sheets;
  throw geo::InputError("repaired: open must be 'auto', 'closed' or 'sheets'");
}

void require_weld(double weld, const char* call) {
  if (!(weld >= 0 && weld <= geo::largest_coordinate))
    throw geo::InputError(std::string(call) + ": weld must be 0 or more");
}

// A valid model if a mesh is one; else InputError, with the remedy of the module.
std::shared_ptr<Solid> checked_solid(const py::object& given) {
  const auto mesh = mesh_argument(given, "mesh");
  plain(*mesh, "Solid");
  return solid_or_remedy(geo::TriangleMesh(mesh->mesh));
}

py::object wrap(const Shared& self, double voxel, const py::object& progress) {
  return py::module_::import("kerf._formats").attr("wrapped")(self, voxel, progress);
}

std::pair<Shared, geo::RepairStats> repaired(const Shared& self, double weld, bool smooth, const std::string& inner) {
  plain(*self, "repair");
  require_weld(weld, "repair");
  const geo::RepairOptions options{weld, smooth, inner_from(inner, "repair")};
  return stoppable("repair", [self, options](const geo::Progress&) {
    auto mesh = self->mesh;
    const auto stats = geo::repair(mesh, options);
    return std::pair{std::make_shared<Mesh>(std::move(mesh)), stats};
  });
}

// As geo::repaired_solid(), with a remedy in the message.
Shared united(const Shared& self, const geo::RepairOptions& options, const py::object& progress) {
  ProgressReport report(progress);
  return report.run([&](const geo::Progress& progress) {
    try {
      return run_apart(progress, "repair", [self, options](const geo::Progress&) {
        return std::make_shared<Mesh>(geo::repaired_solid(self->mesh, options));
      });
    } catch (const geo::GeometryError& e) {
      throw geo::InputError(std::string("repaired: ") + e.what() +
                            "; wrap it in a new surface: voxel=0.005 * diagonal");
    }
  });
}

Shared self_union(const Shared& self, const py::object& progress) {
  plain(*self, "self_union");
  return stoppable(
      "unite", [self](const geo::Progress&) { return std::make_shared<Mesh>(geo::self_union(self->mesh)); }, progress);
}

std::shared_ptr<Solid> rounded(const std::shared_ptr<Solid>& self) {
  const auto model = model_of(self);
  auto mesh = stoppable("round", [model](const geo::Progress&) { return geo::rounded_solid(model->mesh); });
  return std::make_shared<Solid>(std::move(mesh), true);
}

std::shared_ptr<Solid> repaired_solid(const py::object& model, double weld, bool smooth, double voxel, double longest,
                                      const std::string& inner, const std::string& open, const py::object& progress) {
  Shared mesh = mesh_argument(model, "mesh");
  plain(*mesh, "repaired");
  require_weld(weld, "repaired");
  const geo::RepairOptions options{weld, smooth, inner_from(inner, "repaired")};
  const geo::OpenParts parts = open_from(open);
  if (voxel != 0)
    mesh = py::module_::import("kerf._formats")
               .attr("wrapped_solid")(mesh, voxel, weld, smooth, static_cast<int>(options.inner),
                                      static_cast<int>(parts), progress)
               .cast<Shared>();
  else
    mesh = united(mesh, options, progress);
  if (longest != 0) mesh = std::make_shared<Mesh>(refined_mesh(mesh, longest, progress));
  try {
    const bool known = longest == 0;  // valid, by repaired_solid() or wrapped_solid()
    return std::make_shared<Solid>(std::move(mesh->mesh), known);
  } catch (const geo::InputError& e) {
    const std::string what = e.what();
    throw geo::InputError(what.substr(0, what.rfind("; ")) +
                          (voxel > 0 ? "; try another voxel" : "; wrap it in a new surface: voxel=0.005 * diagonal"));
  }
}

std::vector<Shared> convex_decomposition(const Shared& self, std::int64_t count, std::int64_t corners,
                                         py::object progress) {
  if (count < 1 || count > 1000) throw geo::InputError("convex_decomposition: count must be from 1 to 1000");
  if (corners < 4 || corners > 100000) throw geo::InputError("convex_decomposition: corners must be from 4 to 100000");
  if (collapsed_triangles(self->mesh) > 0 || self->mesh.triangles.empty())
    throw geo::InputError("convex_decomposition: the mesh is empty, or a triangle has a vertex twice; repair it");
  const auto work = [self, count, corners](const geo::Progress& own) {
    std::vector<Shared> out;
    for (auto& hull :
         geo::convex_decomposition(self->mesh, static_cast<std::size_t>(count), static_cast<std::size_t>(corners), own))
      out.push_back(std::make_shared<Mesh>(std::move(hull)));
    return out;
  };
  return stoppable("hulls", work, std::move(progress));
}

py::array nearest(const Shared& self, const py::object& points, const py::object& progress) {
  auto at = points_from(points, "points");
  if (self->mesh.triangles.empty()) throw geo::InputError("nearest: the mesh has no triangles");
  return moved<std::uint32_t>(stoppable(
      "nearest", [self, at = std::move(at)](const geo::Progress&) { return geo::nearest_triangles(self->mesh, at); },
      progress));
}

py::dict trimesh_arguments(const py::object& self) {
  py::dict out;
  out["vertices"] = self.attr("vertices");
  out["faces"] = self.attr("faces");
  out["process"] = false;
  const auto& mesh = self.cast<const Mesh&>().mesh;
  py::dict of_faces;
  if (!mesh.patch.empty()) of_faces["patch"] = self.attr("patch");
  if (!mesh.source.empty()) of_faces["source"] = self.attr("source");
  if (!mesh.attributes.group.empty()) of_faces["groups"] = self.attr("groups");
  if (!of_faces.empty()) out["face_attributes"] = of_faces;
  return out;
}

void bind_repair_stats(py::module_& module) {
  using S = geo::RepairStats;
  py::class_<S>(module, "RepairStats", "The changes that Mesh.repair() made, in its order. False where there are none.")
      .def_readonly("welded_vertices", &S::welded_vertices, "Vertices merged into others.")
      .def_readonly("dropped_triangles", &S::dropped_triangles, "Degenerate or duplicate triangles.")
      .def_readonly("flipped_triangles", &S::flipped_triangles, "Triangles whose orientation was reversed.")
      .def_readonly("filled_holes", &S::filled_holes, "Holes that were filled.")
      .def_readonly("added_triangles", &S::added_triangles, "Triangles in holes.")
      .def_readonly("smooth_fills", &S::smooth_fills, "Holes filled by fair patches.")
      .def_readonly("inverted_shells", &S::inverted_shells, "Shells inside out that were turned.")
      .def_readonly("dropped_shells", &S::dropped_shells,
                    "Shells in solid material, oriented like it, that were left out.")
      .def_readonly("hollowed_shells", &S::hollowed_shells,
                    "Shells in solid material, oriented like it, that became cavities, or cores of cavities.")
      .def_readonly("filled_shells", &S::filled_shells, "Other inner shells left out by inner='filled'.")
      .def(
          "__bool__", [](const S& self) { return !self.nothing(); }, "Whether anything was changed.")
      .def("__repr__", [](const S& s) {
        return "<kerf.RepairStats: " + std::to_string(s.welded_vertices) + " vertices welded, " +
               std::to_string(s.dropped_triangles) + " triangles dropped, " + std::to_string(s.flipped_triangles) +
               " flipped, " + std::to_string(s.filled_holes) + " holes filled, " + std::to_string(s.dropped_shells) +
               " shells dropped>";
      });
}

void add_measures(py::class_<Mesh, Shared>& mesh) {
  mesh.def_property_readonly(
          "face_normals",
          [](const Mesh& self) {
            return moved_points(without_gil([&] {
              std::vector<geo::Vec3> out;
              for (const auto& [a, b, c] : geo::corners_of(self.mesh)) out.push_back(geo::face_normal(a, b, c));
              return out;
            }));
          },
          "Unit normal of each triangle, (m, 3) float64; zero where it has no area.")
      .def_property_readonly(
          "corners",
          [](const Mesh& self) {
            return moved<double>(geo::corners_of(self.mesh), {3, 3});
          },
          "Positions of the corners of each triangle, (m, 3, 3) float64.")
      .def_property_readonly(
          "smallest_angles",
          [](const Mesh& self) {
            return moved<double>(without_gil([&] {
              std::vector<double> out;
              for (const auto& corners : geo::corners_of(self.mesh)) out.push_back(geo::smallest_angle(corners));
              return out;
            }));
          },
          "Smallest angle of each triangle, (m,) float64, degrees.")
      .def("nearest", &nearest, py::arg("points"), py::arg_v("progress", py::none()),
           "The triangle nearest to each point, (n, 3): (n,) uint32. Raises InputError for an empty mesh, Interrupted.")
      .def("convex_decomposition", &convex_decomposition, py::arg("count") = 1, py::arg("corners") = 64,
           py::arg_v("progress", py::none()),
           "Approximate convex decomposition of a closed mesh: at most `count` convex hulls, a list of Mesh, of at "
           "most\n"
           "`corners` vertices each (after Mamou and Ghorbel 2009). Hulls below that limit cover the mesh. "
           "Empty\n"
           "for a planar mesh. Raises InputError, Interrupted.");
}

void add_changes(py::class_<Mesh, Shared>& mesh) {
  mesh.def("repair", &repaired, py::arg("weld") = 0.0, py::arg("smooth") = false, py::arg("inner") = "oriented",
           "Repairs the topology of a plain mesh; returns a tuple (Mesh, RepairStats). Welds seams, open ones also "
           "where\n"
           "vertices are up to `weld` apart, model units; drops triangles that bound nothing; orients neighbours "
           "alike;\n"
           "fills each hole, with `smooth` by a fair patch that continues the surface around it; turns shells "
           "outwards.\n"
           "Attributes stay with their triangles. Intersecting triangles remain: see check(). Raises InputError.")
      .def(
          "self_union", &self_union, py::arg_v("progress", py::none()),
          "The boundary of the points where the generalized winding number exceeds a half (Jacobson, Kavan and\n"
          "Sorkine-Hornung 2013): one solid of parts that overlap, touch, cross themselves or have walls inside. Open\n"
          "parts enclose nothing: see repair(). Vertices of triangles that cross nothing stay bit for bit; attributes\n"
          "are interpolated. Returns a Mesh. Raises InputError, GeometryError where nothing is enclosed, Interrupted.")
      .def(
          "refine",
          [](const Shared& self, double longest, const py::object& progress) {
            return std::make_shared<Mesh>(refined_mesh(self, longest, progress));
          },
          py::arg("longest"), py::arg_v("progress", py::none()),
          "A plain mesh with edges of at most `longest`, model units: longer ones are bisected. The shape stays to\n"
          "rounding; attributes are interpolated. Raises InputError where over 20 million triangles would result,\n"
          "Interrupted.")
      .def("wrap", &wrap, py::arg("voxel"), py::arg_v("progress", py::none()),
           "A new surface around closed parts, which may intersect themselves, and open sheets: the zero level of "
           "their\n"
           "distance field, with voxels of edge `voxel`, model units, which also rounds edges by that length. A sheet\n"
           "becomes a plate of that thickness. Its source is the nearest triangle, which gives the attributes. Returns "
           "a Mesh. Raises InputError unless voxel is 0.0005 to 0.1 of "
           "the\n"
           "diagonal, Interrupted.")
      .def(
          "transfer_attributes",
          [](const Shared& self, const py::object& original) {
            const auto from = mesh_argument(original, "original");
            return stoppable("attributes", [self, from](const geo::Progress&) {
              auto mesh = self->mesh;
              geo::transfer_attributes(from->mesh, mesh);
              return std::make_shared<Mesh>(std::move(mesh));
            });
          },
          py::arg("original"),
          "This mesh, whose source names triangles of `original`, with the attributes of that: values at corners of\n"
          "triangles are copied, others interpolated; cracks get defaults. Returns a Mesh. Raises InputError where a\n"
          "source is missing or out of range.")
      .def("to_trimesh_kwargs", &trimesh_arguments,
           "Keyword arguments for trimesh.Trimesh: vertices, faces, process=False, and patch, source and groups as\n"
           "face_attributes.");
}

}  // namespace

geo::TriangleMesh refined_mesh(const Shared& self, double longest, const py::object& progress) {
  plain(*self, "refine");
  if (!(longest > 0)) throw geo::InputError("refine: longest must be positive");
  // A triangle with edges of that length has at most the area of the equilateral one.
  if (geo::area(self->mesh) > 20e6 * 0.25 * std::sqrt(3.0) * longest * longest)
    throw geo::InputError("refine: edges so short would make more than 20 million triangles; let them be longer");
  return stoppable(
      "refine", [self, longest](const geo::Progress&) { return geo::refined(self->mesh, longest); }, progress);
}

void bind_mesh_methods(py::module_& module) {
  bind_repair_stats(module);
  py::class_<Mesh, Shared> mesh(module.attr("Mesh"));
  add_measures(mesh);
  add_changes(mesh);
  py::class_<Solid, Mesh, std::shared_ptr<Solid>>(module.attr("Solid"))
      .def(py::init(&checked_solid), py::arg("mesh"), "Of a Mesh, or an object with vertices and faces.")
      .def(
          "refine",
          [](const std::shared_ptr<Solid>& self, double longest, const py::object& progress) {
            return std::make_shared<Solid>(refined_mesh(self, longest, progress));
          },
          py::arg("longest"), py::arg_v("progress", py::none()),
          "As Mesh.refine(); the result is checked to be a valid model.")
      .def("rounded", &rounded,
           "The model with coordinates in single precision, for files and programs that hold no more: a Solid.\n"
           "Triangles that cross once they are rounded are divided and united. Raises GeometryError where it is no\n"
           "solid after ten rounds.")
      .def_static(
          "repaired", &repaired_solid, py::arg("mesh"), py::arg("weld") = 0.0, py::arg("smooth") = false,
          py::arg("voxel") = 0.0, py::arg("longest") = 0.0, py::arg("inner") = "oriented", py::arg("open") = "auto",
          py::arg_v("progress", py::none()),
          "A valid model of a surface with faults: Mesh.repair(weld, smooth, inner), then Mesh.wrap(voxel), or, where\n"
          "voxel is 0 and triangles cross, Mesh.self_union(), and Mesh.refine(longest) unless that is 0. Lengths are "
          "in\n"
          "model units. open: with a voxel, parts with open edges are sheets where closing them takes half of their\n"
          "area ('auto'), never ('closed'), or always ('sheets'); a sheet becomes a plate one voxel thick. Raises\n"
          "InputError where the result is no valid model, Interrupted.");
}

}  // namespace kerf_python
