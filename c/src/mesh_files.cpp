// Files of meshes and pieces of kerf.h, on disk and in memory.
#include <functional>
#include <sstream>

#include "call.h"
#include "kerf/check.h"
#include "kerf/export.h"
#include "kerf/files.h"
#include "kerf/jobs.h"
#include "kerf/pieces.h"
#include "kerf/repair.h"
#include "objects.h"

namespace kerf_c {
namespace {

// A solid is written so that it is one in single precision.
void write_rounded_stl(std::ostream& out, const geo::TriangleMesh& mesh) {
  const bool solid = !mesh.two_sided() && geo::check_surface(mesh, geo::SelfIntersections::find).good();
  geo::write_stl(out, solid ? geo::rounded_solid(mesh) : mesh);
}

geo::TriangleMesh plain(geo::SurfaceFile file) { return std::move(file.mesh); }

// A mesh as the only piece of a .glb, with its box's middle as its origin.
void write_mesh_glb(std::ostream& out, const geo::TriangleMesh& mesh) {
  const geo::Box3 box = geo::bounding_box(mesh);
  if (box.empty()) throw geo::InputError("a mesh without triangles is no .glb; write a .ply");
  geo::Chunk chunk{mesh, geo::signed_volume(mesh), box.center()};
  chunk.mesh.site.clear();
  geo::write_glb(out, {chunk}, {}, {.kind = "node", .names = {"mesh"}, .strength = 1, .density = 1000});
}

using Writer = std::function<void(std::ostream&)>;

// How a mesh is written in a format; empty for an unknown one.
Writer writer_of(const geo::TriangleMesh& mesh, const std::string& format) {
  if (format == "ply") return [&](std::ostream& out) { geo::write_ply(out, mesh); };
  if (format == "obj") return [&](std::ostream& out) { geo::write_obj(out, mesh); };
  if (format == "stl") return [&](std::ostream& out) { write_rounded_stl(out, mesh); };
  if (format == "off") return [&](std::ostream& out) { geo::write_off(out, mesh); };
  if (format == "glb") return [&](std::ostream& out) { write_mesh_glb(out, mesh); };
  return {};
}

std::shared_ptr<Object> written(const Writer& write) {
  std::ostringstream out;
  write(out);
  return std::make_shared<BytesObject>(std::move(out).str());
}

}  // namespace
}  // namespace kerf_c

using namespace kerf_c;

kerf_status kerf_mesh_load(const char* path, kerf_mesh* mesh) {
  return call([&] {
    NewHandle out(mesh, "mesh");
    out.set(object_for(plain(geo::read_surface(path_of(path, "path")))));
  });
}

kerf_status kerf_mesh_parse(const uint8_t* bytes, size_t length, const char* name, kerf_mesh* mesh) {
  return call([&] {
    NewHandle out(mesh, "mesh");
    const std::string title = text_of(name, "name");
    const std::string content = bytes_of(bytes, length, "bytes");
    if (content.empty()) throw geo::InputError(title + ": is empty");
    out.set(object_for(plain(geo::parse_surface(content, title))));
  });
}

kerf_status kerf_mesh_save(kerf_mesh mesh, const char* path) {
  return call([&] {
    const std::string name = path_of(path, "path");
    const Reading<MeshObject> use(mesh);
    if (name.ends_with(".obj")) {
      geo::save_obj(name, use->mesh);
      return;
    }
    const Writer write = writer_of(use->mesh, name.substr(name.find_last_of('.') + 1));
    if (!write) throw geo::InputError(name + ": give a name that ends with .ply, .obj, .stl, .off or .glb");
    geo::write_all(name, write);
  });
}

kerf_status kerf_mesh_write(kerf_mesh mesh, const char* format, kerf_bytes* bytes) {
  return call([&] {
    NewHandle out(bytes, "bytes");
    const std::string name = text_of(format, "format");
    const Reading<MeshObject> use(mesh);
    const Writer write = writer_of(use->mesh, name);
    if (!write) throw geo::InputError("format '" + name + "' is unknown; give ply, obj, stl, off or glb");
    out.set(written(write));
  });
}

kerf_status kerf_pieces_save(kerf_pieces pieces, const char* path) {
  return call([&] {
    const std::string name = path_of(path, "path");
    const Reading<PiecesObject> use(pieces);
    geo::save(name, use->set);
  });
}

kerf_status kerf_pieces_write(kerf_pieces pieces, const char* format, kerf_bytes* bytes) {
  return call([&] {
    NewHandle out(bytes, "bytes");
    const std::string name = text_of(format, "format");
    const Reading<PiecesObject> use(pieces);
    const geo::PieceSet& set = use->set;
    if (name == "glb")
      out.set(written(
          [&](std::ostream& to) { geo::write_glb(to, set.chunks, set.bonds, set.labels, {.hull_corners = 64}); }));
    else if (name == "usda")
      out.set(written([&](std::ostream& to) { geo::write_usd_pieces(to, set.chunks, set.bonds, set.labels); }));
    else
      throw geo::InputError("format '" + name + "' is unknown; give glb or usda");
  });
}
