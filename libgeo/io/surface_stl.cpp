// STL, ASCII and binary: triangles only, welded where their corners are equal.
#include <cstring>
#include <map>

#include "io/surface_internal.h"
#include "io/text_internal.h"

namespace geo {
namespace {

class Welder {
 public:
  TriangleMesh mesh;
  void add(const std::array<Vec3, 3>& corners) {
    Triangle t;
    for (int k = 0; k < 3; ++k) {
      const std::array<double, 3> key{corners[k].x() + 0.0, corners[k].y() + 0.0, corners[k].z() + 0.0};
      const auto [it, fresh] = rows_.try_emplace(key, static_cast<std::uint32_t>(mesh.vertices.size()));
      if (fresh) mesh.vertices.push_back(corners[k]);
      t[k] = it->second;
    }
    mesh.triangles.push_back(t);
  }

 private:
  std::map<std::array<double, 3>, std::uint32_t> rows_;
};

}  // namespace

TriangleMesh parse_stl(const std::string& bytes, const std::string& name) {
  Welder welder;
  std::uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, bytes.data() + 80, 4);
  const bool binary = bytes.size() >= 84 && bytes.size() == 84 + 50 * static_cast<std::size_t>(count);
  if (!binary && bytes.rfind("solid", 0) != 0) throw InputError(name + ": is no surface file that is known here, or an STL file that is truncated");
  if (binary) {
    for (std::size_t t = 0; t < count; ++t) {
      float f[12];
      std::memcpy(f, bytes.data() + 84 + 50 * t, sizeof f);
      std::array<Vec3, 3> c;
      for (int k = 0; k < 3; ++k) c[k] = Vec3(f[3 + 3 * k], f[4 + 3 * k], f[5 + 3 * k]);
      for (const auto& p : c)
        if (!p.allFinite()) throw InputError(name + ": triangle " + std::to_string(t) + " has a coordinate that is not a finite number; repair the file");
      welder.add(c);
    }
    return std::move(welder.mesh);
  }
  Lines lines(bytes, name, 0);
  std::vector<std::string_view> words;
  std::vector<Vec3> corners;
  bool ended = false;
  while (lines.next(words)) {
    if (words[0] == "vertex") {
      if (words.size() != 4) lines.fail("a vertex needs three coordinates");
      corners.push_back({lines.real(words[1]), lines.real(words[2]), lines.real(words[3])});
    } else if (words[0] == "endfacet") {
      if (corners.size() != 3) lines.fail("a facet needs three vertices");
      welder.add({corners[0], corners[1], corners[2]});
      corners.clear();
    } else if (words[0] == "endsolid") {
      ended = true;
    }
  }
  if (!ended || !corners.empty()) lines.fail("ends without 'endsolid'; the file is truncated");
  return std::move(welder.mesh);
}

}  // namespace geo
