// Meshes of trimesh and Open3D, read by the names of their attributes: neither package is imported.
#include <pybind11/stl.h>

#include <array>
#include <map>

#include "bind.h"
#include "kerf/error.h"
#include "mesh.h"

namespace kerf_python {
namespace {

// The attribute at a dotted path, None where one is missing.
py::object at(py::object object, std::initializer_list<const char*> path) {
  for (const char* name : path) {
    if (object.is_none() || !py::hasattr(object, name)) return py::none();
    object = object.attr(name);
  }
  return object;
}

py::object array(const py::object& values) {
  if (values.is_none()) return values;
  py::object given = py::hasattr(values, "numpy") ? values.attr("numpy")() : values;
  return py::module_::import("numpy").attr("asarray")(given);
}

// The array of a sequence that may be there and empty.
py::object filled(const py::object& values) {
  const auto out = array(values);
  return out.is_none() || out.attr("size").cast<py::ssize_t>() == 0 ? py::object(py::none()) : out;
}

MeshArguments empty_arguments() {
  MeshArguments out;
  for (auto* part : {&out.vertices, &out.faces, &out.uv, &out.normals, &out.colors, &out.groups, &out.group_names,
                     &out.patch, &out.site, &out.source})
    *part = py::none();
  return out;
}

// Vertices at one position become one, as when a file is read: both packages split vertices at
// seams of textures. Attributes belong to corners and stay.
geo::TriangleMesh without_seams(geo::TriangleMesh mesh) {
  std::map<std::array<double, 3>, std::uint32_t> first;
  std::vector<std::uint32_t> merged;
  std::vector<geo::Vec3> vertices;
  for (const auto& p : mesh.vertices) {
    const auto [at, fresh] = first.try_emplace({p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(vertices.size()));
    if (fresh) vertices.push_back(p);
    merged.push_back(at->second);
  }
  for (auto& triangle : mesh.triangles)
    for (auto& corner : triangle) corner = merged[corner];
  mesh.vertices = std::move(vertices);
  return mesh;
}

// (m, k) values of faces as (m, 3, k) values of corners.
py::object per_corner(const py::object& values) {
  const auto numpy = py::module_::import("numpy");
  return numpy.attr("repeat")(values[py::make_tuple(py::slice(py::none(), py::none(), py::none()), py::none())], 3,
                              py::arg("axis") = 1);
}

geo::TriangleMesh from_trimesh(const py::object& mesh) {
  auto arguments = empty_arguments();
  arguments.vertices = array(at(mesh, {"vertices"}));
  arguments.faces = array(at(mesh, {"faces"}));
  if (arguments.vertices.is_none() || arguments.faces.is_none())
    throw geo::InputError("from_trimesh: the object has no vertices or faces; give a trimesh.Trimesh");
  arguments.uv = filled(at(mesh, {"visual", "uv"}));
  const auto kind = at(mesh, {"visual", "kind"});
  const bool by_vertex = py::isinstance<py::str>(kind) && kind.cast<std::string>() == "vertex";
  const bool by_face = py::isinstance<py::str>(kind) && kind.cast<std::string>() == "face";
  if (by_vertex) arguments.colors = filled(at(mesh, {"visual", "vertex_colors"}));
  if (by_face) arguments.colors = filled(at(mesh, {"visual", "face_colors"}));
  if (!arguments.colors.is_none() && by_face) arguments.colors = per_corner(arguments.colors);
  return without_seams(mesh_from(arguments));
}

// Open3D has one mesh class with attributes, and one with dictionaries of tensors.
geo::TriangleMesh from_open3d(const py::object& mesh) {
  auto arguments = empty_arguments();
  const bool tensors = py::hasattr(mesh, "vertex") && py::hasattr(mesh, "triangle");
  const auto tensor = [&](const char* of, const char* name) {
    const py::object values = mesh.attr(of);
    return values.contains(name) ? filled(values[name]) : py::object(py::none());
  };
  if (tensors) {
    arguments.vertices = tensor("vertex", "positions");
    arguments.faces = tensor("triangle", "indices");
    arguments.uv = tensor("triangle", "texture_uvs");
    arguments.colors = tensor("vertex", "colors");
    arguments.normals = tensor("vertex", "normals");
    arguments.groups = tensor("triangle", "material_ids");
  } else {
    arguments.vertices = filled(at(mesh, {"vertices"}));
    arguments.faces = filled(at(mesh, {"triangles"}));
    arguments.uv = filled(at(mesh, {"triangle_uvs"}));
    if (!arguments.uv.is_none()) arguments.uv = arguments.uv.attr("reshape")(-1, 3, 2);
    arguments.colors = filled(at(mesh, {"vertex_colors"}));
    arguments.normals = filled(at(mesh, {"vertex_normals"}));
    arguments.groups = filled(at(mesh, {"triangle_material_ids"}));
  }
  if (arguments.vertices.is_none() || arguments.faces.is_none())
    throw geo::InputError("from_open3d: the object has no vertices or triangles; give an Open3D TriangleMesh");
  return without_seams(mesh_from(arguments));
}

}  // namespace

void bind_imports(py::module_& module) {
  py::class_<Mesh, std::shared_ptr<Mesh>>(module.attr("Mesh"))
      .def_static(
          "from_trimesh", [](const py::object& mesh) { return std::make_shared<Mesh>(from_trimesh(mesh)); },
          py::arg("mesh"),
          "The mesh of a trimesh.Trimesh, with its texture coordinates and colours; it may have holes.\n"
          "Vertices at one position become one. Raises InputError.")
      .def_static(
          "from_open3d", [](const py::object& mesh) { return std::make_shared<Mesh>(from_open3d(mesh)); },
          py::arg("mesh"),
          "The mesh of an Open3D TriangleMesh, of either of its classes, with texture coordinates, colours, normals\n"
          "and material ids as groups; it may have holes. Vertices at one position become one. Raises InputError.");
  py::class_<Solid, Mesh, std::shared_ptr<Solid>>(module.attr("Solid"))
      .def_static(
          "from_trimesh", [](const py::object& mesh) { return solid_or_remedy(from_trimesh(mesh)); }, py::arg("mesh"),
          "As Mesh.from_trimesh(), a model. Raises InputError where it is no valid solid.")
      .def_static(
          "from_open3d", [](const py::object& mesh) { return solid_or_remedy(from_open3d(mesh)); }, py::arg("mesh"),
          "As Mesh.from_open3d(), a model. Raises InputError where it is no valid solid.");
}

}  // namespace kerf_python
