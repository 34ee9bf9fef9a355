// Meshes of kerf.h: their arrays, measures, checks and repair; procedural ones.
#include <algorithm>
#include <cstring>

#include "call.h"
#include "kerf/check.h"
#include "kerf/pieces.h"
#include "kerf/repair.h"
#include "objects.h"

namespace kerf_c {
namespace {

// Triangles with indices of vertices that are there.
std::vector<geo::Triangle> triangles_of(const kerf_mesh_arrays& arrays, std::size_t vertices) {
  const auto faces = array_of(arrays.faces, arrays.faces_length, 3, "faces");
  std::vector<geo::Triangle> triangles(faces.size() / 3);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (faces[i] >= vertices)
      throw ArgumentError("faces: triangle " + std::to_string(i / 3) + " names vertex " + std::to_string(faces[i]) +
                          ", but there are " + std::to_string(vertices));
    triangles[i / 3][i % 3] = faces[i];
  }
  return triangles;
}

// An attribute of corners; each is a vector of numbers. No array: no attribute.
template <class Vector>
std::vector<std::array<Vector, 3>> corners_from(const double* data, std::size_t length, std::size_t triangles,
                                                const char* name) {
  constexpr int width = Vector::RowsAtCompileTime;
  const auto values = array_of(data, length, 3 * width, name);
  if (!values.empty() && values.size() != 3 * width * triangles)
    throw ArgumentError(std::string(name) + ": the length is " + std::to_string(length) + "; give " +
                        std::to_string(width) + " numbers for each corner, " + std::to_string(3 * width * triangles));
  for (const double x : values)
    if (!(std::abs(x) <= 1e30)) throw ArgumentError(std::string(name) + ": a number is not finite, or too large");
  std::vector<std::array<Vector, 3>> result(values.size() / (3 * width));
  for (std::size_t i = 0; i < values.size(); ++i)
    result[i / (3 * width)][i / width % 3][static_cast<Eigen::Index>(i % width)] = values[i];
  return result;
}

void set_groups(const kerf_mesh_arrays& arrays, geo::TriangleMesh& mesh) {
  const auto groups = array_of(arrays.groups, arrays.groups_length, 1, "groups");
  const auto names = array_of(arrays.group_names, arrays.group_names_length, 1, "group_names");
  if (!groups.empty() && groups.size() != mesh.triangles.size())
    throw ArgumentError("groups: give one for each of the " + std::to_string(mesh.triangles.size()) + " triangles");
  for (const char* name : names) {
    std::string text = text_of(name, "a name in group_names");
    if (text.find_first_of("\r\n") != text.npos) throw ArgumentError("group_names: a name is one line of text");
    mesh.attributes.group_names.push_back(std::move(text));
  }
  for (const std::int32_t group : groups)
    if (group < 0 || static_cast<std::size_t>(group) >= names.size())
      throw ArgumentError("groups: " + std::to_string(group) + " is no index of one of the " +
                          std::to_string(names.size()) + " names");
  mesh.attributes.group.assign(groups.begin(), groups.end());
}

geo::TriangleMesh mesh_of(const kerf_mesh_arrays& arrays) {
  geo::TriangleMesh mesh;
  mesh.vertices = points_of(arrays.vertices, arrays.vertices_length, "vertices");
  if (mesh.vertices.size() >= 0xffffffffu) throw ArgumentError("vertices: there are more than 2^32 - 2");
  mesh.triangles = triangles_of(arrays, mesh.vertices.size());
  const std::size_t count = mesh.triangles.size();
  mesh.attributes.uv = corners_from<geo::Vec2>(arrays.uv, arrays.uv_length, count, "uv");
  mesh.attributes.normal = corners_from<geo::Vec3>(arrays.normals, arrays.normals_length, count, "normals");
  mesh.attributes.color = corners_from<geo::Color>(arrays.colors, arrays.colors_length, count, "colors");
  set_groups(arrays, mesh);
  mesh.unit = number_of(arrays.unit, 0, 1e12, "unit");
  return mesh;
}

// The numbers of an array of points, triangles or corners, without a copy.
template <class T, class Element>
void give(const std::vector<Element>& from, const T*& data, std::size_t& length) {
  static_assert(sizeof(Element) % sizeof(T) == 0);
  data = from.empty() ? nullptr : reinterpret_cast<const T*>(from.data());
  length = from.size() * (sizeof(Element) / sizeof(T));
}

void copy_report(const geo::SurfaceReport& from, kerf_report& to) {
  to = {};
  to.good = from.good() ? 1 : 0;
  to.closed = from.closed ? 1 : 0;
  to.manifold = from.manifold ? 1 : 0;
  to.oriented = from.oriented ? 1 : 0;
  to.degenerate_faces = from.degenerate_faces;
  to.self_intersections = from.self_intersections.value_or(0);
  to.shells = from.shells.size();
  std::strncpy(to.first_problem, from.first_problem.c_str(), sizeof to.first_problem - 1);
}

geo::SelfIntersections crossings_of(std::int32_t flag) {
  return flag_of(flag, "self_intersections") ? geo::SelfIntersections::find : geo::SelfIntersections::ignore;
}

}  // namespace

std::shared_ptr<Object> object_for(geo::TriangleMesh mesh) {
  return std::make_shared<MeshObject>(std::make_shared<const geo::TriangleMesh>(std::move(mesh)));
}

}  // namespace kerf_c

using namespace kerf_c;

kerf_status kerf_bytes_data(kerf_bytes bytes, const uint8_t** data, size_t* length) {
  return call([&] {
    required(data, "data");
    required(length, "length");
    const Reading<BytesObject> use(bytes);
    *data = reinterpret_cast<const uint8_t*>(use->bytes.data());
    *length = use->bytes.size();
  });
}

kerf_status kerf_mesh_create(const kerf_mesh_arrays* arrays, kerf_mesh* mesh) {
  return call([&] {
    NewHandle out(mesh, "mesh");
    out.set(object_for(mesh_of(required(arrays, "arrays"))));
  });
}

kerf_status kerf_mesh_get(kerf_mesh mesh, kerf_mesh_arrays* arrays) {
  return call([&] {
    kerf_mesh_arrays& to = required(arrays, "arrays");
    const Reading<MeshObject> use(mesh);
    const geo::TriangleMesh& from = use->mesh;
    to = {};
    give(from.vertices, to.vertices, to.vertices_length);
    give(from.triangles, to.faces, to.faces_length);
    give(from.attributes.uv, to.uv, to.uv_length);
    give(from.attributes.normal, to.normals, to.normals_length);
    give(from.attributes.color, to.colors, to.colors_length);
    give(from.attributes.group, to.groups, to.groups_length);
    give(use->group_names, to.group_names, to.group_names_length);
    give(from.patch, to.patch, to.patch_length);
    give(from.source, to.source, to.source_length);
    to.unit = from.unit;
  });
}

kerf_status kerf_mesh_measures(kerf_mesh mesh, kerf_measures* measures) {
  return call([&] {
    kerf_measures& to = required(measures, "measures");
    const Reading<MeshObject> use(mesh);
    const geo::MassProperties mass = geo::mass_properties(use->mesh);
    const geo::Box3 box = geo::bounding_box(use->mesh);
    if (box.empty()) throw geo::InputError("the mesh has no triangles to measure");
    to.volume = mass.volume;
    to.area = geo::area(use->mesh);
    copy_point(box.lo, to.low);
    copy_point(box.hi, to.high);
    copy_point(mass.centroid, to.centroid);
  });
}

kerf_status kerf_mesh_check(kerf_mesh mesh, int32_t self_intersections, kerf_report* report) {
  return call([&] {
    kerf_report& to = required(report, "report");
    const auto crossings = crossings_of(self_intersections);
    const Reading<MeshObject> use(mesh);
    copy_report(geo::check_surface(use->mesh, crossings), to);
  });
}

kerf_status kerf_complex_check(kerf_complex complex, int32_t self_intersections, kerf_report* report) {
  return call([&] {
    kerf_report& to = required(report, "report");
    const auto crossings = crossings_of(self_intersections);
    const Reading<ComplexObject> use(complex);
    copy_report(geo::check_complex(use->complex, crossings), to);
  });
}

kerf_status kerf_mesh_repaired(kerf_mesh mesh, double weld, int32_t smooth, kerf_mesh* solid) {
  return call([&] {
    NewHandle out(solid, "solid");
    geo::RepairOptions options;
    options.weld_distance = number_of(weld, 0, geo::largest_coordinate, "weld");
    options.smooth_fill = flag_of(smooth, "smooth");
    const Reading<MeshObject> use(mesh);
    if (use->mesh.two_sided()) throw geo::InputError("the surface has cracks; make a kerf_complex of it");
    out.set(object_for(geo::repaired_solid(use->mesh, options)));
  });
}

kerf_status kerf_mesh_refine(kerf_mesh mesh, double longest, kerf_mesh* refined) {
  return call([&] {
    NewHandle out(refined, "refined");
    number_of(longest, 1e-300, 1e300, "longest");
    const Reading<MeshObject> use(mesh);
    if (use->mesh.two_sided()) throw geo::InputError("the surface has cracks, and is not refined; refine the model");
    out.set(object_for(geo::refined(use->mesh, longest)));
  });
}

kerf_status kerf_mesh_convex_decomposition(kerf_mesh mesh, size_t count, size_t corners, kerf_mesh* hulls,
                                           size_t* hull_count) {
  return call([&] {
    required(hulls, "hulls");
    required(hull_count, "hull_count");
    *hull_count = 0;
    number_of(static_cast<double>(count), 1, 1000, "count");
    number_of(static_cast<double>(corners), 4, 100000, "corners");
    const Reading<MeshObject> use(mesh);
    if (use->mesh.triangles.empty()) throw geo::InputError("the mesh has no triangles, and so no hull");
    auto found = geo::convex_decomposition(use->mesh, count, corners);
    for (geo::TriangleMesh& hull : found)
      hulls[(*hull_count)++] = static_cast<kerf_mesh>(handle_for(object_for(std::move(hull))));
  });
}

kerf_status kerf_shape_block(const double size[3], double edge, kerf_mesh* mesh) {
  return call([&] {
    NewHandle out(mesh, "mesh");
    const geo::Vec3 extent = point_of(size, "size");
    number_of(edge, 1e-60, 1e60, "edge");
    const geo::Vec3 cells = (extent / edge).cwiseMax(1);
    constexpr double most = 2e7;  // triangles, as of geo::refined()
    if (4 * (cells.x() * cells.y() + cells.y() * cells.z() + cells.z() * cells.x()) > most)
      throw geo::InputError("edge: the block would have more than 20 million triangles; give a longer edge");
    out.set(object_for(geo::make_block(extent, edge)));
  });
}

kerf_status kerf_shape_sphere(int32_t frequency, kerf_mesh* mesh) {
  return call([&] {
    NewHandle out(mesh, "mesh");
    number_of(frequency, 1, 1000, "frequency");
    out.set(object_for(geo::make_sphere(frequency)));
  });
}

kerf_status kerf_shape_pumpkin(int32_t frequency, kerf_mesh* mesh) {
  return call([&] {
    NewHandle out(mesh, "mesh");
    number_of(frequency, 1, 1000, "frequency");
    out.set(object_for(geo::make_pumpkin(frequency)));
  });
}
