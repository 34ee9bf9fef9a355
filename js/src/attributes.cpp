// Checks and attributes of meshes (bind.h): typed arrays with a row for each corner of each face, and groups.
#include <array>

#include <kerf/check.h>
#include "bind.h"

namespace kerf_js {
namespace {

// Values of corners: one row for each corner of each face, or one for each vertex.
template <class Value>
std::vector<std::array<Value, 3>> corners_from(const val& given, const char* name, const geo::TriangleMesh& mesh) {
  constexpr std::size_t width = Value::RowsAtCompileTime;
  if (!has(given, name)) return {};
  const auto numbers = numbers_from<double>(given[name]);
  const bool by_vertex = numbers.size() == width * mesh.vertices.size();
  if (!by_vertex && numbers.size() != 3 * width * mesh.triangles.size())
    throw geo::InputError(std::string(name) + ": give " + std::to_string(width) +
                          " numbers for each vertex, or for each corner of each face");
  std::vector<std::array<Value, 3>> corners(mesh.triangles.size());
  for (std::size_t f = 0; f < corners.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t row = by_vertex ? mesh.triangles[f][k] : 3 * f + k;
      for (std::size_t i = 0; i < width; ++i) corners[f][k][static_cast<Eigen::Index>(i)] = numbers[width * row + i];
    }
  return corners;
}

template <class Value>
val corners_to(const std::vector<std::array<Value, 3>>& corners) {
  if (corners.empty()) return val::undefined();
  constexpr std::size_t width = Value::RowsAtCompileTime;
  return array_of(corners[0][0].data(), 3 * width * corners.size());
}

void read_groups(const val& given, geo::TriangleMesh& mesh) {
  if (!has(given, "groups")) return;
  const auto groups = numbers_from<std::int32_t>(given["groups"]);
  const auto names = has(given, "groupNames") ? emscripten::vecFromJSArray<std::string>(given["groupNames"])
                                              : std::vector<std::string>();
  if (groups.size() != mesh.triangles.size()) throw geo::InputError("groups: give one for each face");
  for (const auto group : groups)
    if (group < 0 || static_cast<std::size_t>(group) >= names.size())
      throw geo::InputError("groups: each is an index of groupNames");
  mesh.attributes.group = groups;
  mesh.attributes.group_names = names;
}

}  // namespace

void demand_solid(const geo::TriangleMesh& mesh) {
  try {
    geo::require_solid(mesh);
  } catch (const geo::InputError& e) {
    throw geo::InputError(std::string(e.what()) + ", or try Solid.repaired()");
  }
}

void read_attributes(const val& given, geo::TriangleMesh& mesh) {
  mesh.attributes.uv = corners_from<geo::Vec2>(given, "uv", mesh);
  mesh.attributes.normal = corners_from<geo::Vec3>(given, "normals", mesh);
  mesh.attributes.color = corners_from<geo::Color>(given, "colors", mesh);
  read_groups(given, mesh);
}

val attribute_array(const geo::Attributes& attributes, const std::string& name) {
  if (name == "groups") return attributes.group.empty() ? val::undefined() : array_of(attributes.group);
  if (name == "groupNames") return val::array(attributes.group_names);
  if (name == "uv") return corners_to(attributes.uv);
  if (name == "normals") return corners_to(attributes.normal);
  if (name == "colors") return corners_to(attributes.color);
  return val::undefined();
}

}  // namespace kerf_js
