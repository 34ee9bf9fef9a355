// read_surface() of kerf/files.h. Formats are recognised by their first bytes or lines;
// anything unknown is read as STL. Seams, i.e. vertices at one position, are welded unless the mesh
// is two-sided.
#include "kerf/files.h"

#include <algorithm>

#include "io/line_reader.h"
#include "io/surface_formats.h"
#include "io/surface_other.h"
#include "kerf/body_file.h"
#include "surface/polygon.h"
#include "surface/weld.h"

namespace geo {
namespace {

bool looks_like_obj(const std::string& bytes) {
  LineReader lines(bytes, "");
  std::vector<std::string_view> words;
  for (int i = 0; i < 200 && lines.next(words); ++i)
    if (words[0] == "v" || words[0] == "vn" || words[0] == "f") return true;
  return false;
}

bool looks_like_off(const std::string& bytes) {
  LineReader lines(std::string_view(bytes).substr(0, 4096), "");
  std::vector<std::string_view> words;
  // COFF and NOFF add colours and normals to the coordinates; other prefixes change the
  // coordinates. The keyword is optional: counts of vertices, faces and edges may come first.
  if (!lines.next(words)) return false;
  const auto numbers = [&](std::string_view allowed) {
    return words.size() == 3 && std::all_of(words.begin(), words.end(), [&](std::string_view word) {
             return word.find_first_not_of(allowed) == std::string_view::npos;
           });
  };
  if (numbers("0123456789")) return lines.next(words) && numbers("0123456789+-.eE");
  return words[0] == "OFF" || words[0] == "COFF" || words[0] == "NOFF" || words[0] == "CNOFF";
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> add_polygon(TriangleMesh& mesh, const std::vector<std::uint32_t>& polygon,
                                                      const std::string& where) {
  if (polygon.size() < 3) throw InputError(where + "a face has fewer than three vertices");
  for (const auto v : polygon)
    if (v >= mesh.vertices.size())
      throw InputError(where + "a face names vertex " + std::to_string(v) + ", but there are " +
                       std::to_string(mesh.vertices.size()));
  auto triangles = triangles_of(mesh.vertices, polygon);
  for (const auto& [a, b, c] : triangles) mesh.triangles.push_back({polygon[a], polygon[b], polygon[c]});
  return triangles;
}

SurfaceFile read_surface(const std::string& path) { return parse_surface(read_all(path), path); }

SurfaceFile parse_surface(const std::string& bytes, const std::string& name) {
  // Text that begins with the byte order mark of UTF-8 is read without it.
  if (bytes.rfind("\xef\xbb\xbf", 0) == 0) return parse_surface(bytes.substr(3), name);
  SurfaceFile file;
  if (bytes.rfind("ply", 0) == 0)
    file = parse_surface_ply(bytes, name);
  else if (looks_like_kerf(bytes))
    throw InputError(name + ": is a body (.kerf); give the surface that it was made of, or that it was cut by");
  else if (const OtherFormat other = other_format(bytes, name); !other.what.empty())
    file.mesh = parse_other(bytes, name, other);
  else if (looks_like_off(bytes))
    file.mesh = parse_off(bytes, name);
  else if (looks_like_obj(bytes))
    file.mesh = parse_obj(bytes, name);
  else
    file.mesh = parse_stl(bytes, name);
  for (std::size_t v = 0; v < file.mesh.vertices.size(); ++v)
    if (!in_range(file.mesh.vertices[v]))
      throw InputError(name + ": vertex " + std::to_string(v) +
                       " has a coordinate that is not a finite number of sensible size; repair the file");
  if (!file.mesh.two_sided()) weld_seams(file.mesh);
  if (file.mesh.triangles.empty()) throw InputError(name + ": has no triangles; give a closed triangle mesh");
  return file;
}

}  // namespace geo
