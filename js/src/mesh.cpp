// Meshes: made of arrays and files, measured, checked, repaired, saved.
#include <malloc.h>

#include <sstream>

#include <kerf/check.h>
#include <kerf/export.h>
#include <kerf/files.h>
#include <kerf/pieces.h>
#include <kerf/repair.h>
#include "bind.h"

namespace kerf_js {
namespace {

// vertices: Float64Array; faces: Uint32Array; attributes: uv, normals, colors, groups, groupNames.
val make_mesh(const val& vertices, const val& faces, const val& attributes) {
  return guarded([&] {
    geo::TriangleMesh mesh;
    mesh.vertices = points_from(vertices, "vertices");
    const auto corners = numbers_from<std::uint32_t>(faces);
    if (corners.size() % 3 != 0) throw geo::InputError("faces: give three vertices for each");
    for (std::size_t i = 0; i < corners.size(); ++i)
      if (corners[i] >= mesh.vertices.size())
        throw geo::InputError("faces: face " + std::to_string(i / 3) + " has the vertex " + std::to_string(corners[i]) +
                              ", but there are " + std::to_string(mesh.vertices.size()));
    for (std::size_t i = 0; i < corners.size(); i += 3)
      mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
    read_attributes(attributes, mesh);
    return handle(std::move(mesh));
  });
}

// An array of the mesh by its name; undefined: it has none.
val mesh_array(const MeshHandle& m, const std::string& name) {
  const geo::TriangleMesh& mesh = m->mesh;
  const auto unless_empty = [](const auto& numbers) { return numbers.empty() ? val::undefined() : array_of(numbers); };
  if (name == "vertices") return array_of(mesh.vertices);
  if (name == "faces")
    return array_of(mesh.triangles.empty() ? nullptr : mesh.triangles.data()->data(), 3 * mesh.triangles.size());
  if (name == "patch") return unless_empty(mesh.patch);
  if (name == "source") return unless_empty(mesh.source);
  if (name == "site") return unless_empty(mesh.site);
  return attribute_array(mesh.attributes, name);
}

val mesh_measures(const MeshHandle& m) {
  const geo::MassProperties mass = geo::mass_properties(m->mesh);
  const geo::Box3 box = geo::bounding_box(m->mesh);
  val result = val::object();
  result.set("volume", geo::signed_volume(m->mesh));
  result.set("area", geo::area(m->mesh));
  result.set("centroid", array_of(mass.centroid));
  result.set("inertia", array_of(mass.inertia.data(), 9));
  result.set("bounds", array_of(std::vector<geo::Vec3>{box.lo, box.hi}));
  result.set("unit", m->mesh.unit);
  return result;
}

val check_mesh(const MeshHandle& m) {
  return guarded([&] {
    const geo::SurfaceReport report = geo::check_surface(m->mesh, geo::SelfIntersections::find);
    val result = val::object();
    result.set("closed", report.closed);
    result.set("manifold", report.manifold);
    result.set("oriented", report.oriented);
    result.set("degenerateFaces", double(report.degenerate_faces));
    result.set("firstProblem", report.first_problem);
    result.set("good", report.good());
    return result;
  });
}

val require_solid_mesh(const MeshHandle& m) {
  return guarded([&] { demand_solid(m->mesh); });
}

val repaired(const MeshHandle& m, const val& options) {
  return guarded([&] {
    geo::RepairOptions o;
    take(options, "weld", o.weld_distance, 0, 1e300);
    o.smooth_fill = has(options, "smooth") && options["smooth"].as<bool>();
    return handle(geo::repaired_solid(m->mesh, o));
  });
}

val load(const val& bytes, const std::string& name) {
  return guarded([&] {
    geo::SurfaceFile file = geo::parse_surface(text_from(bytes), name);
    val result = val::object();
    result.set("notes", val::array(file.notes));
    result.set("mesh", handle(std::move(file.mesh)));
    return result;
  });
}

val save(const MeshHandle& m, const std::string& format) {
  return guarded([&] {
    std::ostringstream out;
    const geo::TriangleMesh& mesh = m->mesh;
    if (format == "ply") {
      geo::write_ply(out, mesh);
    } else if (format == "obj") {
      geo::write_obj(out, mesh);
    } else if (format == "stl") {
      geo::write_stl(out, mesh);
    } else if (format == "off") {
      geo::write_off(out, mesh);
    } else if (format == "glb") {
      const geo::MassProperties mass = geo::mass_properties(mesh);
      geo::ChunkLabels labels;
      labels.kind = "node";
      labels.names = {"model"};
      geo::write_glb(out, {{.mesh = mesh, .volume = mass.volume, .centroid = mass.centroid}}, {}, labels);
    } else {
      throw geo::InputError("save: '" + format + "' is none of ply, obj, glb, stl, off");
    }
    return bytes_of(std::move(out).str());
  });
}

val hulls(const MeshHandle& m, const val& options) {
  return guarded([&] {
    int parts = 1, corners = 64;
    take(options, "parts", parts, 1, 1000);
    take(options, "corners", corners, 4, 100000);
    val result = val::array();
    for (geo::TriangleMesh& hull :
         geo::convex_decomposition(m->mesh, static_cast<std::size_t>(parts), static_cast<std::size_t>(corners)))
      append(result, val(handle(std::move(hull))));
    return result;
  });
}

// ---- Refinement, shapes

// Triangles, as of geo::refined(). Solids of so many need more than the 2 GB of a module's memory.
constexpr double most_triangles = 2e7;

val refined(const MeshHandle& m, const val& longest) {
  return guarded([&] {
    const double edge = longest.isNumber() ? longest.as<double>() : 0;
    if (!(edge > 0)) throw geo::InputError("longest: give a length above 0");
    if (m->mesh.two_sided()) throw geo::InputError("the surface has cracks, and is not refined; refine the model");
    return handle(geo::refined(m->mesh, edge));
  });
}

geo::TriangleMesh block(const geo::Vec3& size, const val& options) {
  double edge = 0.25;
  take(options, "edge", edge, 1e-60, 1e60);
  const geo::Vec3 cells = (size / edge).cwiseMax(1);
  if (4 * (cells.x() * cells.y() + cells.y() * cells.z() + cells.z() * cells.x()) > most_triangles)
    throw geo::InputError("edge: the block would have more than 20 million triangles; give a longer edge");
  return geo::make_block(size, edge);
}

geo::TriangleMesh letter(const val& options) {
  const auto name = options["letter"].isString() ? options["letter"].as<std::string>() : std::string();
  if (name.size() != 1) throw geo::InputError("letter: give one capital letter");
  int resolution = 12;
  double depth = 0.2;
  take(options, "resolution", resolution, 12, 1000);
  take(options, "depth", depth, 1e-6, 1e6);
  return geo::make_letter(name[0], depth, resolution);
}

// A shape by its name: {size, edge}, {letter, depth, resolution} or {frequency}.
val shape(const std::string& name, const val& options) {
  return guarded([&] {
    if (name == "block") return handle(block(point_from(options["size"], "size"), options));
    if (name == "letter") return handle(letter(options));
    int frequency = 16;
    take(options, "frequency", frequency, 1, 1000);
    if (name == "sphere") return handle(geo::make_sphere(frequency));
    if (name == "pumpkin") return handle(geo::make_pumpkin(frequency));
    if (name == "apple") return handle(geo::make_apple(frequency));
    return handle(geo::make_polyp(frequency));
  });
}

// Bytes of the heap that are in use, for tests of leaks.
double used_bytes() { return double(mallinfo().uordblks); }

}  // namespace

EMSCRIPTEN_BINDINGS(kerf_mesh) {
  emscripten::class_<Mesh>("MeshHandle").smart_ptr<MeshHandle>("MeshHandle");
  emscripten::function("makeMesh", &make_mesh);
  emscripten::function("meshArray", &mesh_array);
  emscripten::function("meshMeasures", &mesh_measures);
  emscripten::function("checkMesh", &check_mesh);
  emscripten::function("requireSolid", &require_solid_mesh);
  emscripten::function("repaired", &repaired);
  emscripten::function("load", &load);
  emscripten::function("save", &save);
  emscripten::function("hulls", &hulls);
  emscripten::function("refined", &refined);
  emscripten::function("shape", &shape);
  emscripten::function("usedBytes", &used_bytes);
}

}  // namespace kerf_js
