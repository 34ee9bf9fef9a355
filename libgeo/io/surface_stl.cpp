// parse_stl() of io/surface_formats.h. STL, ASCII and binary: triangles only, three vertices each.
#include <cstring>

#include "io/line_reader.h"
#include "io/surface_formats.h"

namespace geo {
namespace {

void add(TriangleMesh& mesh, const Vec3 (&corners)[3]) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), corners, corners + 3);
  mesh.triangles.push_back({first, first + 1, first + 2});
}

}  // namespace

TriangleMesh parse_stl(const std::string& bytes, const std::string& name) {
  TriangleMesh mesh;
  std::uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, bytes.data() + 80, 4);
  const bool binary = bytes.size() >= 84 && bytes.size() == 84 + 50 * static_cast<std::size_t>(count);
  if (!binary && bytes.rfind("solid", 0) != 0)
    throw InputError(name + ": is no surface file that is known here, or an STL file that is truncated");
  if (binary) {
    for (std::size_t t = 0; t < count; ++t) {
      float f[12];
      std::memcpy(f, bytes.data() + 84 + 50 * t, sizeof f);
      Vec3 c[3];
      for (int k = 0; k < 3; ++k) c[k] = Vec3(f[3 + 3 * k], f[4 + 3 * k], f[5 + 3 * k]);
      for (const auto& p : c)
        if (!p.allFinite())
          throw InputError(name + ": triangle " + std::to_string(t) +
                           " has a coordinate that is not a finite number; repair the file");
      add(mesh, c);
    }
    return mesh;
  }
  LineReader lines(bytes, name, 0);
  std::vector<std::string_view> words;
  std::vector<Vec3> corners;
  bool ended = false;
  while (lines.next(words)) {
    if (words[0] == "vertex") {
      if (words.size() != 4) lines.fail("a vertex needs three coordinates");
      corners.push_back({lines.real(words[1]), lines.real(words[2]), lines.real(words[3])});
    } else if (words[0] == "endfacet") {
      if (corners.size() != 3) lines.fail("a facet needs three vertices");
      add(mesh, {corners[0], corners[1], corners[2]});
      corners.clear();
    } else if (words[0] == "endsolid") {
      ended = true;
    }
  }
  if (!ended || !corners.empty()) lines.fail("ends without 'endsolid'; the file is truncated");
  return mesh;
}

}  // namespace geo
