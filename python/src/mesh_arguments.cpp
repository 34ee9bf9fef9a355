// Arrays of a mesh: attributes per vertex are spread to the corners of the triangles, so that every
// later stage knows one form.
#include <algorithm>

#include "kerf/error.h"
#include "mesh.h"

namespace kerf_python {
namespace {

// Values of `width` numbers per corner: given as (n, width) per vertex or (m, 3, width) per corner.
template <class Value>
std::vector<std::array<Value, 3>> corners_from(py::handle object, const std::string& name,
                                               const geo::TriangleMesh& mesh, std::size_t least) {
  if (object.is_none()) return {};
  const std::size_t width = Value::RowsAtCompileTime;
  const auto [shape, values] = values_from(object, name, 2, 3);
  const auto given = shape.back();
  const bool per_vertex = shape.size() == 2 && shape[0] == mesh.vertices.size();
  const bool per_corner = shape.size() == 3 && shape[0] == mesh.triangles.size() && shape[1] == 3;
  if (!(per_vertex || per_corner) || given < least || given > width)
    throw geo::InputError(name + ": give (vertices, " + std::to_string(width) + ") or (faces, 3, " +
                          std::to_string(width) + ") numbers");
  std::vector<std::array<Value, 3>> out(mesh.triangles.size());
  for (std::size_t t = 0; t < out.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto row = per_vertex ? mesh.triangles[t][k] : 3 * t + k;
      Value value = Value::Ones();  // an alpha that is not given is 1
      for (std::size_t i = 0; i < given; ++i) value[static_cast<Eigen::Index>(i)] = values[row * given + i];
      out[t][k] = value;
    }
  return out;
}

void set_groups(geo::TriangleMesh& mesh, const MeshArguments& arguments) {
  auto& attributes = mesh.attributes;
  if (arguments.groups.is_none()) {
    if (!arguments.group_names.is_none()) throw geo::InputError("group_names: given without groups; give groups, too");
    return;
  }
  const auto count = mesh.triangles.size();
  if (!arguments.group_names.is_none())
    for (const auto name : arguments.group_names) attributes.group_names.push_back(py::str(name));
  if (py::isinstance<py::list>(arguments.groups) || py::isinstance<py::tuple>(arguments.groups)) {
    const auto list = py::reinterpret_borrow<py::sequence>(arguments.groups);
    const bool names = py::len(list) > 0 && py::isinstance<py::str>(list[0]);
    if (names) {
      for (const auto item : list) {
        const auto name = py::str(item).cast<std::string>();
        const auto at = std::find(attributes.group_names.begin(), attributes.group_names.end(), name);
        attributes.group.push_back(static_cast<std::int32_t>(at - attributes.group_names.begin()));
        if (at == attributes.group_names.end()) attributes.group_names.push_back(name);
      }
      if (attributes.group.size() != count)
        throw geo::InputError("groups: " + std::to_string(attributes.group.size()) + " names for " +
                              std::to_string(count) + " faces; give one per face");
      return;
    }
  }
  const std::int64_t limit = attributes.group_names.empty() ? 65535 : std::int64_t(attributes.group_names.size()) - 1;
  const auto values = integers_from(arguments.groups, "groups", 0, limit);
  if (values.size() != count)
    throw geo::InputError("groups: " + std::to_string(values.size()) + " values for " + std::to_string(count) +
                          " faces; give one per face");
  attributes.group.assign(values.begin(), values.end());
  const auto most = values.empty() ? 0 : *std::max_element(values.begin(), values.end());
  for (auto i = std::int64_t(attributes.group_names.size()); !values.empty() && i <= most; ++i)
    attributes.group_names.push_back("group_" + std::to_string(i));
}

template <class T>
std::vector<T> per_element(py::handle object, const std::string& name, std::size_t count, std::int64_t least,
                           std::int64_t greatest) {
  if (object.is_none()) return {};
  const auto values = integers_from(object, name, least, greatest);
  if (values.size() != count)
    throw geo::InputError(name + ": " + std::to_string(values.size()) + " values; give " + std::to_string(count));
  std::vector<T> out(values.size());
  std::transform(values.begin(), values.end(), out.begin(), [](std::int64_t v) { return static_cast<T>(v); });
  return out;
}

// Colours from 0 to 1: bytes are divided by 255. Throws InputError for other numbers outside.
py::object unit_colors(const py::object& colors) {
  if (colors.is_none()) return colors;
  const py::object array = py::module_::import("numpy").attr("asarray")(colors);
  const auto kind = array.attr("dtype").attr("kind").cast<std::string>();
  if (kind == "u" && array.attr("dtype").attr("itemsize").cast<int>() == 1) return array / py::float_(255.0);
  const bool integers = (kind == "u" || kind == "i") && array.attr("size").cast<py::ssize_t>() > 0;
  if (integers && array.attr("max")().cast<double>() > 1)
    throw geo::InputError("colors: integers above 1; give floats from 0 to 1, or uint8");
  if (kind != "f" || array.attr("size").cast<py::ssize_t>() == 0) return colors;
  constexpr double slack = 1e-6;  // what arithmetic with float32 adds
  for (const double value : {array.attr("min")().cast<double>(), array.attr("max")().cast<double>()})
    if (value < -slack || value > 1 + slack)
      throw geo::InputError("colors: a value of " + py::str(py::float_(value)).cast<std::string>() +
                            "; give floats from 0 to 1, or uint8");
  return colors;
}

}  // namespace

geo::TriangleMesh mesh_from(const MeshArguments& arguments) {
  geo::TriangleMesh mesh;
  mesh.vertices = points_from(arguments.vertices, "vertices");
  constexpr std::size_t most = 1u << 31;
  if (mesh.vertices.size() >= most) throw geo::InputError("vertices: more than 2^31; give a smaller mesh");
  mesh.triangles = triangles_from(arguments.faces, "faces", mesh.vertices.size());
  const auto vertices = mesh.vertices.size(), faces = mesh.triangles.size();
  mesh.attributes.uv = corners_from<geo::Vec2>(arguments.uv, "uv", mesh, 2);
  mesh.attributes.normal = corners_from<geo::Vec3>(arguments.normals, "normals", mesh, 3);
  mesh.attributes.color = corners_from<geo::Color>(unit_colors(arguments.colors), "colors", mesh, 3);
  mesh.attributes.materials = arguments.materials;
  set_groups(mesh, arguments);
  mesh.patch = per_element<std::int32_t>(arguments.patch, "patch", faces, -(1LL << 30), 1LL << 30);
  mesh.site = per_element<std::uint32_t>(arguments.site, "site", vertices, 0, 0xffffffffLL);
  mesh.source = per_element<std::uint32_t>(arguments.source, "source", faces, 0, 0xffffffffLL);
  if (mesh.patch.empty() != mesh.site.empty() && faces > 0)
    throw geo::InputError("patch, site: a two-sided surface has both; give both or neither");
  return mesh;
}

std::shared_ptr<Mesh> mesh_argument(py::handle object, const std::string& name) {
  if (py::isinstance<Mesh>(object)) return object.cast<std::shared_ptr<Mesh>>();
  if (!object.is_none() && py::hasattr(object, "vertices") && py::hasattr(object, "faces")) {
    MeshArguments arguments;
    for (auto* at : {&arguments.uv, &arguments.normals, &arguments.colors, &arguments.groups, &arguments.group_names,
                     &arguments.patch, &arguments.site, &arguments.source})
      *at = py::none();
    arguments.vertices = object.attr("vertices");
    arguments.faces = object.attr("faces");
    return std::make_shared<Mesh>(mesh_from(arguments));
  }
  throw geo::InputError(name + ": give a kerf.Mesh, or an object with vertices and faces");
}

}  // namespace kerf_python
