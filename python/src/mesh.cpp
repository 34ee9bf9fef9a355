// Mesh and Solid. Every array is a view whose base is the mesh object itself.
#include "mesh.h"

#include <pybind11/stl.h>

#include <filesystem>

#include "bind.h"
#include "kerf/appearance.h"
#include "kerf/files.h"

namespace kerf_python {
namespace {

using Size = py::ssize_t;

// A view of a vector of the mesh, None where it is empty. `inner`: the shape of one element.
template <class T, class E>
py::object array_of(const py::object& self, const std::vector<E>& values, std::vector<Size> inner) {
  if (values.empty()) return py::none();
  std::vector<Size> shape{static_cast<Size>(values.size())};
  shape.insert(shape.end(), inner.begin(), inner.end());
  return view<T>(values.data(), std::move(shape), self);
}

// As array_of(), an empty array where there are no values: for arrays that every mesh has.
template <class T, class E>
py::array rows_of(const py::object& self, const std::vector<E>& values) {
  return view<T>(values.data(), {static_cast<Size>(values.size()), 3}, self);
}

const geo::TriangleMesh& mesh_of(const py::object& self) { return self.cast<const Mesh&>().mesh; }

// The materials of groups that an .mtl file describes, with their images; none where there is no
// such file. They are read as those of an OBJ file beside it.
void add_materials(geo::TriangleMesh& mesh) {
  const std::filesystem::path file = mesh.attributes.materials;
  if (file.empty() || mesh.attributes.group_names.empty() || !std::filesystem::is_regular_file(file)) return;
  std::string obj = "mtllib " + file.filename().string() + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n";
  for (const std::string& name : mesh.attributes.group_names) obj += "usemtl " + name + "\nf 1/1 2/1 3/1\n";
  const auto read = geo::parse_surface(obj, (file.parent_path() / "groups.obj").string());
  mesh.attributes.library = read.mesh.attributes.library;
}

// Arguments of the constructors.
geo::TriangleMesh made(py::object vertices, py::object faces, py::object uv, py::object normals, py::object colors,
                       py::object groups, py::object group_names, const std::string& materials, py::object patch,
                       py::object site, py::object source) {
  auto mesh = mesh_from({std::move(vertices), std::move(faces), std::move(uv), std::move(normals), std::move(colors),
                         std::move(groups), std::move(group_names), std::move(patch), std::move(site),
                         std::move(source), materials});
  add_materials(mesh);
  return mesh;
}

// The base colour of each group as (factor, image), which is the bytes of a PNG or JPEG, or None.
py::list base_colors(const Mesh& self) {
  const auto found = geo::base_colors(self.mesh.attributes);
  py::list out;
  for (const auto& of : found.of_group)
    out.append(py::make_tuple(
        py::make_tuple(of.factor[0], of.factor[1], of.factor[2], of.factor[3]),
        of.image == geo::BaseColor::no_image ? py::object(py::none()) : py::object(py::bytes(found.images[of.image]))));
  return out;
}

template <class Class>
void add_arrays(Class& mesh) {
  mesh.def_property_readonly(
          "vertices", [](const py::object& self) { return rows_of<double>(self, mesh_of(self).vertices); },
          "Positions, (n, 3) float64, model units. Read-only view.")
      .def_property_readonly(
          "faces", [](const py::object& self) { return rows_of<std::uint32_t>(self, mesh_of(self).triangles); },
          "Vertex indices of each triangle, counter-clockwise from outside, (m, 3) uint32. Read-only view.")
      .def_property_readonly(
          "uv",
          [](const py::object& self) {
            return array_of<double>(self, mesh_of(self).attributes.uv, {3, 2});
          },
          "Texture coordinates per corner, (m, 3, 2) float64, or None. Read-only view.")
      .def_property_readonly(
          "normals",
          [](const py::object& self) {
            return array_of<double>(self, mesh_of(self).attributes.normal, {3, 3});
          },
          "Normals per corner, (m, 3, 3) float64, or None. Read-only view.")
      .def_property_readonly(
          "colors",
          [](const py::object& self) {
            return array_of<double>(self, mesh_of(self).attributes.color, {3, 4});
          },
          "Colours per corner, (m, 3, 4) float64: red, green, blue, alpha, 0 to 1; or None. Read-only view.")
      .def_property_readonly(
          "groups",
          [](const py::object& self) { return array_of<std::int32_t>(self, mesh_of(self).attributes.group, {}); },
          "Group of each triangle, (m,) int32, an index into group_names; or None. Read-only view.")
      .def_property_readonly(
          "group_names", [](const Mesh& self) { return py::tuple(py::cast(self.mesh.attributes.group_names)); },
          "Names of the groups.")
      .def_property_readonly(
          "uv2",
          [](const py::object& self) {
            return array_of<double>(self, mesh_of(self).attributes.uv2, {3, 2});
          },
          "A second set of texture coordinates per corner, (m, 3, 2) float64, or None. Read-only view.")
      .def_property_readonly(
          "unit",
          [](const Mesh& self) { return self.mesh.unit > 0 ? py::object(py::float_(self.mesh.unit)) : py::none(); },
          "The metres that one unit of the coordinates is, or None where nothing says so.")
      .def_property_readonly(
          "materials", [](const Mesh& self) { return self.mesh.attributes.materials; },
          "File that describes materials of the groups' names, or ''.")
      .def_property_readonly(
          "patch", [](const py::object& self) { return array_of<std::int32_t>(self, mesh_of(self).patch, {}); },
          "(m,) int32: 0 skin, +c and -c the two sides of crack c; or None. Read-only view.")
      .def_property_readonly(
          "site", [](const py::object& self) { return array_of<std::uint32_t>(self, mesh_of(self).site, {}); },
          "(n,) uint32: vertex of the crack complex at which each vertex stands; or None. Read-only view.")
      .def_property_readonly(
          "source", [](const py::object& self) { return array_of<std::uint32_t>(self, mesh_of(self).source, {}); },
          "(m,) uint32: triangle of the surface that was cut which contains this one, 2**32 - 1 for cracks; or\n"
          "None. Read-only view.");
}

template <class Class>
void add_measures(Class& mesh) {
  mesh.def_property_readonly(
          "two_sided", [](const Mesh& self) { return self.mesh.two_sided(); },
          "Whether this is a two-sided surface, with patch and site.")
      .def_property_readonly(
          "volume", [](const Mesh& self) { return geo::signed_volume(self.mesh); },
          "Signed volume, model units cubed; positive where normals point outwards.")
      .def_property_readonly(
          "area", [](const Mesh& self) { return geo::area(self.mesh); }, "Total area, model units squared.")
      .def_property_readonly(
          "bounds",
          [](const Mesh& self) {
            const auto box = geo::bounding_box(self.mesh);
            return moved_points(std::vector<geo::Vec3>{box.lo, box.hi});
          },
          "Lowest and highest corner of the box around all triangles, (2, 3); infinite without triangles.")
      .def("__len__", [](const Mesh& self) { return self.mesh.triangles.size(); })
      .def("__repr__", [](const py::object& self) {
        const auto& mesh = mesh_of(self);
        return "<kerf." + py::str(py::type::of(self).attr("__name__")).template cast<std::string>() + " of " +
               std::to_string(mesh.vertices.size()) + " vertices and " + std::to_string(mesh.triangles.size()) +
               " faces>";
      });
}

constexpr const char* mesh_doc =
    "A triangle mesh with attributes. It never changes; its arrays are read-only views.\n\n"
    "Mesh(vertices, faces, *, uv, normals, colors, groups, group_names, materials, patch, site, source)\n\n"
    "vertices: (n, 3) floats or integers. faces: (m, 3) integers. uv (…, 2), normals (…, 3) and colors (…, 3 or 4)\n"
    "have one row per vertex, (n, …), or per corner, (m, 3, …). colors: 0 to 1, or uint8. groups: (m,) integers or "
    "names; materials: an .mtl file that describes groups by their names. patch and site: of a\n"
    "two-sided surface. source: (m,) integers. Arrays are checked and copied. Raises InputError.";
constexpr const char* solid_doc =
    "A valid model: a closed, manifold mesh, oriented outwards, that does not intersect itself.\n\n"
    "Arguments as for Mesh. Raises InputError, which says what is wrong and how to repair it, for any other mesh.";

}  // namespace

void bind_mesh(py::module_& module) {
  py::class_<Mesh, std::shared_ptr<Mesh>> mesh(module, "Mesh", mesh_doc);
  const auto optional = [](const char* name) { return py::arg_v(name, py::none()); };
  mesh.def(
      py::init([](py::object v, py::object f, py::object uv, py::object n, py::object c, py::object g, py::object names,
                  const std::string& materials, py::object patch, py::object site, py::object source) {
        return std::make_shared<Mesh>(made(v, f, uv, n, c, g, names, materials, patch, site, source));
      }),
      py::arg("vertices"), py::arg("faces"), py::kw_only(), optional("uv"), optional("normals"), optional("colors"),
      optional("groups"), optional("group_names"), py::arg("materials") = "", optional("patch"), optional("site"),
      optional("source"), "See the class.");
  add_arrays(mesh);
  add_measures(mesh);
  mesh.def("_base_colors", &base_colors);

  py::class_<Solid, Mesh, std::shared_ptr<Solid>> solid(module, "Solid", solid_doc);
  solid.def(py::init([](py::object v, py::object f, py::object uv, py::object n, py::object c, py::object g,
                        py::object names, const std::string& materials) {
              const auto none = py::none();
              return solid_or_remedy(made(v, f, uv, n, c, g, names, materials, none, none, none));
            }),
            py::arg("vertices"), py::arg("faces"), py::kw_only(), optional("uv"), optional("normals"),
            optional("colors"), optional("groups"), optional("group_names"), py::arg("materials") = "",
            "See the class.");
}

}  // namespace kerf_python
