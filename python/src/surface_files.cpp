// Files of surfaces: PLY, OBJ, STL, OFF, glTF, FBX and more in; PLY, OBJ and glTF out. The content
// of a file decides which class it becomes.
#include <pybind11/stl.h>

#include <algorithm>
#include <cctype>

#include "apart.h"
#include "arguments.h"
#include "bind.h"
#include "complex.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/export.h"
#include "kerf/files.h"
#include "kerf/repair.h"
#include "kind.h"
#include "pieces.h"

namespace kerf_python {
namespace {

// Whether a path has this ending, in capitals or not.
bool ends(const std::string& path, const std::string& ending) {
  const auto same = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
  return path.size() >= ending.size() &&
         std::equal(path.end() - std::ptrdiff_t(ending.size()), path.end(), ending.begin(), same);
}

[[noreturn]] void unknown_ending(const std::string& path, const char* known) {
  throw geo::InputError(path + ": ends in no known format; give " + known);
}

// The metres of a unit that a caller names; 0 without a name. Throws InputError.
double metres_of(const std::string& unit) {
  if (unit.empty()) return 0;
  const auto metres = geo::length_unit(unit);
  if (!metres) throw geo::InputError("unit: '" + unit + "' is none; give one of " + geo::length_unit_names());
  return *metres;
}

// Raises what a reader left out as warnings of Python, which may be errors there.
geo::SurfaceFile with_warnings(geo::SurfaceFile&& file, const std::string& name, const std::string& unit) {
  if (!unit.empty()) file.mesh.unit = metres_of(unit);
  for (const std::string& note : file.notes)
    if (PyErr_WarnEx(PyExc_UserWarning, (name + ": " + note).c_str(), 1) != 0) throw py::error_already_set();
  return std::move(file);
}

// Writes an OBJ file with its materials beside it, and warns of what it does not hold.
void save_as_obj(const std::string& path, geo::TriangleMesh&& mesh) {
  const auto things = without_gil([&] { return geo::save_obj(path, std::move(mesh)); });
  std::string text;
  for (const std::string& thing : things) text += (text.empty() ? "" : ", ") + thing;
  if (text.empty()) return;
  text = path + ": left out: " + text + "; a .ply keeps them";
  if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw py::error_already_set();
}

// Warns of what STL and OFF do not hold. Throws InputError where single precision is too coarse.
void warn_of_plain(const geo::TriangleMesh& mesh, const std::string& path) {
  const bool stl = ends(path, ".stl");
  if (!stl && !ends(path, ".off")) return;
  if (stl && !geo::single_precision_offset(geo::bounding_box(mesh)).isZero(0))
    throw geo::InputError(path + ": the model is too far from the origin for single precision; save a .ply");
  if (mesh.attributes.empty() && mesh.patch.empty()) return;
  const std::string text = path + ": left out: all but vertices and faces; a .ply keeps them";
  if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw py::error_already_set();
}

// Warns where a .glb gets an offset.
void warn_of_offset(const geo::Box3& box, const std::string& path) {
  if (!ends(path, ".glb") || geo::single_precision_offset(box).isZero(0)) return;
  const std::string text = path + ": the model is far from the origin; the root node moves it there";
  if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw py::error_already_set();
}

geo::SurfaceFile parsed(const std::string& bytes, const std::string& name, const std::string& unit) {
  return with_warnings(stoppable("read", [=](const geo::Progress&) { return geo::parse_surface(bytes, name); }), name,
                       unit);
}

geo::SurfaceFile read(const Path& path, const std::string& unit) {
  return with_warnings(stoppable("read", [=](const geo::Progress&) { return geo::read_surface(path.text); }), path.text,
                       unit);
}

std::shared_ptr<Complex> with_fronts(geo::SurfaceFile&& file, const std::string& name) {
  const auto fronts = std::move(file.fronts);
  try {
    auto complex = complex_of(std::make_shared<Mesh>(std::move(file.mesh)));
    for (const auto& state : fronts)
      complex->fronts.push_back(std::make_shared<FrontRecord>(FrontRecord{state, {}, {}}));
    return complex;
  } catch (const geo::InputError& e) {
    throw geo::InputError(name + ": " + e.what());
  }
}

// Removes the sites of a surface that no crack has cut: frames of a run have them from the first.
void forget_sites(geo::TriangleMesh& mesh) {
  if (!std::any_of(mesh.patch.begin(), mesh.patch.end(), [](auto patch) { return patch != 0; })) {
    mesh.patch.clear();
    mesh.site.clear();
  }
}

std::shared_ptr<Solid> solid_of(geo::SurfaceFile&& file, const std::string& name) {
  forget_sites(file.mesh);
  if (file.mesh.two_sided()) throw geo::InputError(name + ": is cut already; give it to kerf.Complex.load()");
  try {
    return solid_or_remedy(std::move(file.mesh));
  } catch (const geo::InputError& e) {
    throw geo::InputError(name + ": " + e.what());
  }
}

// A Complex where the surface is cut, a Solid where it is one, else a Mesh.
py::object any_surface(const Path& path, const std::string& unit) {
  const auto shared = std::make_shared<geo::SurfaceFile>(read(path, unit));
  const bool valid = stoppable("check", [shared](const geo::Progress&) {
    return geo::check_surface(shared->mesh, geo::SelfIntersections::find).good();
  });
  auto& file = *shared;
  if (!valid) return py::cast(std::make_shared<Mesh>(std::move(file.mesh)));
  if (file.fronts.empty()) forget_sites(file.mesh);
  if (file.mesh.two_sided()) return py::cast(with_fronts(std::move(file), path.text));
  return py::cast(std::make_shared<Solid>(std::move(file.mesh), true));
}

// A mesh as the only chunk.
geo::Chunk chunk_of(const Mesh& given, double unit) {
  const auto* piece = dynamic_cast<const Piece*>(&given);
  const auto box = geo::bounding_box(given.mesh);
  if (box.empty()) throw geo::InputError("save: a mesh without triangles is no .glb");
  geo::Chunk chunk{given.mesh, piece ? piece->volume : geo::signed_volume(given.mesh),
                   piece ? piece->centroid : box.center()};
  chunk.mesh.site.clear();
  if (unit > 0) chunk.mesh.unit = unit;
  return chunk;
}

// One node, whose origin is the middle of the box; a piece's is its centroid.
void write_glb(std::ostream& out, const Mesh& mesh, double unit) {
  const auto* piece = dynamic_cast<const Piece*>(&mesh);
  geo::write_glb(out, {chunk_of(mesh, unit)}, {},
                 {"node", {piece ? geo::piece_name(piece->index) : std::string("mesh")}, 1});
}

// A .ply with another unit than the mesh's.
void write_ply(std::ostream& out, const geo::TriangleMesh& mesh, double unit) {
  if (!(unit > 0) || unit == mesh.unit) return geo::write_ply(out, mesh);
  geo::TriangleMesh stated = mesh;
  stated.unit = unit;
  geo::write_ply(out, stated);
}

// A solid as an .stl holds it: valid in single precision. Any other mesh as it is, and a piece in
// which a crack ends.
std::shared_ptr<Mesh> as_stl(const std::shared_ptr<Mesh>& mesh) {
  if (!dynamic_cast<const Solid*>(mesh.get())) return mesh;
  return stoppable("round", [mesh](const geo::Progress&) {
    geo::TriangleMesh bare;
    bare.vertices = mesh->mesh.vertices;
    bare.triangles = mesh->mesh.triangles;
    if (!mesh->is_model() && !geo::check_surface(bare, geo::SelfIntersections::find).good()) return mesh;
    return std::make_shared<Mesh>(geo::rounded_solid(bare));
  });
}

// Warns where triangles of a model cross in the coordinates of a .glb.
void warn_of_rounding(const Mesh& mesh, const geo::Chunk& chunk, const std::string& path) {
  if (!mesh.is_model()) return;
  const auto pairs = without_gil([&] { return geo::crossings_in_single_precision(chunk); });
  if (pairs == 0) return;
  const std::string text = path + ": " + std::to_string(pairs) + (pairs == 1 ? " pair" : " pairs") +
                           " of triangles cross in single precision; save rounded(), or a .ply";
  if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw py::error_already_set();
}

void save_mesh(const std::shared_ptr<Mesh>& given, const Path& path, const std::string& unit_name) {
  const std::string& p = path.text;
  const double unit = metres_of(unit_name);
  if (!ends(p, ".ply") && !ends(p, ".obj") && !ends(p, ".glb") && !ends(p, ".stl") && !ends(p, ".off"))
    unknown_ending(p, ".ply, .obj, .glb, .stl or .off");
  const auto written = ends(p, ".stl") ? as_stl(given) : given;
  const Mesh& self = *written;
  if (ends(p, ".obj")) return save_as_obj(p, geo::TriangleMesh(self.mesh));
  if (ends(p, ".glb")) warn_of_rounding(self, chunk_of(self, unit), p);
  warn_of_plain(given->mesh, p);
  warn_of_offset(geo::bounding_box(self.mesh), p);
  without_gil([&] {
    geo::write_all(p, [&](std::ostream& out) {
      if (ends(p, ".ply")) return write_ply(out, self.mesh, unit);
      if (ends(p, ".stl")) return geo::write_stl(out, self.mesh);
      if (ends(p, ".off")) return geo::write_off(out, self.mesh);
      write_glb(out, self, unit);
    });
  });
}

struct Exported {
  std::vector<geo::Chunk> chunks;
  std::vector<geo::Bond> bonds;
  geo::ChunkLabels labels;
};

// To be called without the GIL.
Exported exported(const Complex& self, const geo::Pieces& found, double tile, double strength) {
  static const geo::TriangleMesh no_model;
  Exported out{geo::make_chunks(self.complex, found, self.model ? self.model->mesh : no_model,
                                tile * self.complex.extent().diagonal()),
               geo::find_bonds(self.complex, found),
               {"node", geo::piece_names(found.count), strength}};
  return out;
}

void require_tile(double tile, double strength) {
  if (!(tile > 0 && tile <= 1e6)) throw geo::InputError("save: tile must be above 0 and at most 1000000");
  if (!(strength >= 0 && strength <= 1e100)) throw geo::InputError("save: strength must be 0 or more");
}

// Options of Complex.save() for a .glb.
struct SaveOptions {
  int corners, parts;
  double tile, strength;
  bool z_up;
};

void save_complex(Complex& self, const Path& path, const SaveOptions& w, const std::string& unit_name) {
  const std::string& p = path.text;
  const double unit = metres_of(unit_name);
  if (!ends(p, ".ply") && !ends(p, ".obj") && !ends(p, ".glb")) unknown_ending(p, ".ply, .obj or .glb");
  require_tile(w.tile, w.strength);
  if (w.corners != 0 && (w.corners < 4 || w.corners > 100000))
    throw geo::InputError("save: corners must be 0 or from 4 to 100000");
  if (w.parts < 1 || w.parts > 1000) throw geo::InputError("save: parts must be from 1 to 1000");
  warn_of_offset(self.complex.extent(), p);
  const Reading reading(self.busy);
  if (ends(p, ".obj")) return save_as_obj(p, without_gil([&] { return self.surface(); }));
  const auto found = ends(p, ".glb") ? self.found() : nullptr;
  std::vector<geo::FrontState> fronts;
  for (const auto& front : self.fronts) fronts.push_back(front->state);
  without_gil([&] {
    geo::write_all(p, [&](std::ostream& out) {
      if (ends(p, ".ply")) {
        geo::TriangleMesh mesh = self.surface();
        if (unit > 0) mesh.unit = unit;
        return geo::write_ply(out, mesh, fronts);
      }
      auto e = exported(self, *found, w.tile, w.strength);
      if (unit > 0)
        for (geo::Chunk& chunk : e.chunks) chunk.mesh.unit = unit;
      geo::write_glb(out, e.chunks, e.bonds, e.labels,
                     {static_cast<std::size_t>(w.corners), static_cast<std::size_t>(w.parts), w.z_up});
    });
  });
}

void save_bonds(Complex& self, const Path& path, double strength) {
  require_tile(1, strength);
  const Reading reading(self.busy);
  const auto found = self.found();
  without_gil([&] {
    const auto e = exported(self, *found, 1, strength);
    geo::write_all(path, [&](std::ostream& out) { geo::write_bonds(out, e.chunks, e.bonds, e.labels); });
  });
}

py::object rows_of(const std::vector<geo::Vec3>& rows) {
  if (rows.empty()) return py::none();
  py::array_t<double> out({static_cast<py::ssize_t>(rows.size()), py::ssize_t(3)});
  std::copy_n(rows[0].data(), 3 * rows.size(), out.mutable_data());
  return out;
}

// Positions, normals and colours, the latter two None where there are none.
py::tuple read_points(const Path& path) {
  const geo::PointCloud cloud = without_gil([&] { return geo::read_points(path.text); });
  std::vector<geo::Vec3> colors;
  for (const geo::Color& c : cloud.color) colors.push_back(c.head<3>());
  return py::make_tuple(rows_of(cloud.position), rows_of(cloud.normal), rows_of(colors));
}

std::string kind_name(const Path& path) {
  const auto bytes = without_gil([&] { return geo::read_all(path.text); });
  static constexpr const char* names[] = {"body", "nodes", "fronts", "surface"};
  // The first bytes of every OpenVDB file: " BDV" as a 64-bit number.
  if (bytes.starts_with(std::string(" BDV\0\0\0\0", 8))) return "volume";
  return names[static_cast<int>(tool::kind_of(bytes, path.text))];
}

constexpr const char* read_doc =
    "Reads PLY, OBJ, STL, OFF, glTF, FBX and more. Polygons are triangulated; coincident vertices of seams are\n"
    "merged. unit: of the coordinates, \"mm\" and so on, in place of what the file states. What is left out is a\n"
    "warning. ";

}  // namespace

void bind_surface_files(py::module_& module) {
  static const std::string mesh_doc =
      std::string(read_doc) +
      "The mesh is not tested: kerf.load() does. Raises InputError, with the line, for a\n"
      "malformed file.";
  static const std::string solid_doc =
      std::string(read_doc) + "Raises InputError for a malformed file and for a surface that is no valid solid.";
  static const std::string complex_doc = std::string(read_doc) +
                                         "With the fronts that were cutting a two-sided surface. Raises\nInputError "
                                         "for a malformed file, and as Complex().";
  py::class_<Mesh, std::shared_ptr<Mesh>>(module.attr("Mesh"))
      .def_static(
          "load",
          [](const Path& path, const std::string& unit) { return std::make_shared<Mesh>(read(path, unit).mesh); },
          py::arg("path"), py::arg("unit") = "", mesh_doc.c_str())
      .def_static(
          "parse",
          [](const py::bytes& data, const std::string& name, const std::string& unit) {
            return std::make_shared<Mesh>(parsed(data.cast<std::string>(), name, unit).mesh);
          },
          py::arg("data"), py::arg("name") = "bytes", py::arg("unit") = "",
          "As load(), from bytes in memory; `name` stands for the file in messages.")
      .def("save", &save_mesh, py::arg("path"), py::arg("unit") = "",
           "Writes .ply (binary, with all arrays), .obj, .glb (glTF 2.0, in metres), .stl or .off, by the path's "
           "ending.\n"
           "unit: of\n"
           "the coordinates, \"mm\" and so on, in place of the mesh's own. The file is replaced when it is complete.\n"
           "Raises OutputError where it cannot be written, InputError for another ending.");
  py::class_<Solid, Mesh, std::shared_ptr<Solid>>(module.attr("Solid"))
      .def_static(
          "load", [](const Path& path, const std::string& unit) { return solid_of(read(path, unit), path.text); },
          py::arg("path"), py::arg("unit") = "", solid_doc.c_str());
  py::class_<Complex, std::shared_ptr<Complex>>(module.attr("Complex"))
      .def_static(
          "load", [](const Path& path, const std::string& unit) { return with_fronts(read(path, unit), path.text); },
          py::arg("path"), py::arg("unit") = "", complex_doc.c_str())
      .def(
          "save",
          [](Complex& self, const Path& path, int corners, int parts, double tile, double strength, bool z_up,
             const std::string& unit) {
            save_complex(self, path, {corners, parts, tile, strength, z_up}, unit);
          },
          py::arg("path"), py::arg("corners") = 0, py::arg("parts") = 1, py::arg("tile") = 0.25,
          py::arg("strength") = 1.0, py::arg("z_up") = false, py::arg("unit") = "",
          "Writes surface(): .ply with its fronts, which load() reads back, or .obj; or the pieces with their bonds "
          "as\n"
          ".glb (glTF 2.0): a node for each piece (§ 7). For .glb: corners of convex hulls, 0: no hulls; parts, hulls\n"
          "for each piece; tile, size of a texture tile on inner faces, a fraction of the diagonal; strength, force "
          "per\n"
          "square metre; z_up: the model's z axis is vertical; unit: of the coordinates, \"mm\" and so on, in place "
          "of\n"
          "the model's own: a .glb is in metres. Raises OutputError, InputError.")
      .def("save_bonds", &save_bonds, py::arg("path"), py::arg("strength") = 1.0,
           "Writes pieces and bonds as JSON (docs/formats.md). strength: force per unit of area that a bond "
           "withstands.\n"
           "Raises OutputError, InputError.");
  module.def("_kind", &kind_name, py::arg("path"));
  module.def("_read_points", &read_points, py::arg("path"));
  module.def("_load_surface", &any_surface, py::arg("path"), py::arg("unit") = "");
}

}  // namespace kerf_python
