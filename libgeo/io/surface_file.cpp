#include "io/surface_file.h"

#include "io/stream.h"
#include "io/surface_internal.h"
#include "io/text_internal.h"

namespace geo {
namespace {

bool looks_like_obj(const std::string& bytes) {
  Lines lines(bytes, "");
  std::vector<std::string_view> words;
  for (int i = 0; i < 200 && lines.next(words); ++i)
    if (words[0] == "v" || words[0] == "vn" || words[0] == "f") return true;
  return false;
}

bool looks_like_off(const std::string& bytes) {
  Lines lines(std::string_view(bytes).substr(0, 4096), "");
  std::vector<std::string_view> words;
  // COFF and NOFF carry colours and normals behind the coordinates; other prefixes change what a coordinate is.
  return lines.next(words) && (words[0] == "OFF" || words[0] == "COFF" || words[0] == "NOFF" || words[0] == "CNOFF");
}

}  // namespace

std::uint32_t row_of(double x) { return x >= 0 && x < 4294967295.0 && x == std::floor(x) ? static_cast<std::uint32_t>(x) : ~0u; }

void add_polygon(TriangleMesh& mesh, const std::vector<std::uint32_t>& polygon, const std::string& where) {
  if (polygon.size() < 3) throw InputError(where + "a face has fewer than three vertices");
  for (const auto v : polygon)
    if (v >= mesh.vertices.size())
      throw InputError(where + "a face names vertex " + std::to_string(v) + ", but there are " + std::to_string(mesh.vertices.size()));
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) mesh.triangles.push_back({polygon[0], polygon[k], polygon[k + 1]});
}

SurfaceFile read_surface(const std::string& path) { return parse_surface(read_all(path), path); }

SurfaceFile parse_surface(const std::string& bytes, const std::string& name) {
  SurfaceFile file;
  if (bytes.rfind("ply", 0) == 0)
    file = parse_surface_ply(bytes, name);
  else if (looks_like_off(bytes))
    file.mesh = parse_off(bytes, name);
  else if (looks_like_obj(bytes))
    file.mesh = parse_obj(bytes, name);
  else
    file.mesh = parse_stl(bytes, name);
  if (file.mesh.triangles.empty()) throw InputError(name + ": has no triangles; give a closed triangle mesh");
  return file;
}

}  // namespace geo
