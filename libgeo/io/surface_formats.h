// Readers of the surface formats, and helpers that they share with the writers.
#pragma once

#include <string>
#include <vector>

#include "kerf/files.h"
#include "kerf/mesh.h"

namespace geo {

// One reader for each format. `name` stands for the file in messages. Each throws InputError as
// parse_surface(). `notes` receives what a reader leaves out or assumes, as SurfaceFile::notes.

/// Reads PLY with patch, site, source, attributes and fronts.
SurfaceFile parse_surface_ply(const std::string& bytes, const std::string& name);
/// Reads Wavefront OBJ. A face may name vertices, texture coordinates and normals of later lines.
TriangleMesh parse_obj(const std::string& bytes, const std::string& name, std::vector<std::string>& notes);
/// Whether text begins as an OFF file does: with its keyword, or with counts and numbers.
bool looks_like_off(const std::string& bytes);
/// Reads OFF and its variants with texture coordinates (ST), colours (C), normals (N) and a fourth
/// coordinate that divides the others (4).
TriangleMesh parse_off(const std::string& bytes, const std::string& name, std::vector<std::string>& notes);
/// Whether the bytes are as long as a binary STL file with the number of facets in its header.
bool is_exact_binary_stl(const std::string& bytes);
/// Reads ASCII or binary STL.
TriangleMesh parse_stl(const std::string& bytes, const std::string& name, std::vector<std::string>& notes);

/// Reads glTF 2.0, binary or text: all meshes of the default scene, as its nodes, instances and
/// skins place them. Vertices with a skin stand where its joints place them in the file's pose.
/// Materials become groups, with a library of them. Throws InputError as parse_surface(), and where
/// the file requires an extension that is not known here.
SurfaceFile parse_gltf(const std::string& bytes, const std::string& name);

/// A number as an index; ~0u (no index) if it is negative, fractional or too large.
inline std::uint32_t row_of(double x) {
  if (!(x >= 0 && x < 4294967295.0)) return ~0u;
  const auto row = static_cast<std::uint32_t>(x);
  return static_cast<double>(row) == x ? row : ~0u;
}

/// "1 line", "3 lines": for notes. `plural`: where it is not the noun with an s.
inline std::string counted(std::size_t n, const std::string& noun, const std::string& plural = {}) {
  return std::to_string(n) + ' ' + (n == 1 ? noun : plural.empty() ? noun + 's' : plural);
}
/// One note of the things that a reader leaves out; none where `things` is empty.
void add_left_out(std::vector<std::string>& notes, const std::vector<std::string>& things);

/// Adds a polygon of n corners as n − 2 triangles: a fan about corner 0, or by ear clipping where
/// the fan would fold over. Returns the corners of each triangle. Throws InputError, with `where`
/// first.
std::vector<std::array<std::uint32_t, 3>> add_polygon(TriangleMesh& mesh, const std::vector<std::uint32_t>& polygon,
                                                      const std::string& where);

/// Values of vertices at the corners of triangles.
template <class V>
std::vector<std::array<V, 3>> at_corners(const TriangleMesh& mesh, const std::vector<V>& at_vertex) {
  std::vector<std::array<V, 3>> result;
  result.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) result.push_back({at_vertex[a], at_vertex[b], at_vertex[c]});
  return result;
}

/// Values of corners at vertices. A vertex takes the value of its first corner; corners of skin
/// precede corners of cracks. `agree`: whether all corners of skin have the value of their vertex.
template <class V>
struct AtVertices {
  std::vector<V> value;
  bool agree = true;
};
/// See AtVertices.
template <class V>
AtVertices<V> at_vertices(const TriangleMesh& mesh, const std::vector<std::array<V, 3>>& at_corner) {
  AtVertices<V> result;
  result.value.assign(mesh.vertices.size(), V::Zero());
  std::vector<char> rank(mesh.vertices.size(), 0);  // 1: from a crack, 2: from the skin
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const char here = mesh.patch.empty() || mesh.patch[t] == 0 ? 2 : 1;
    for (int k = 0; k < 3; ++k) {
      const auto v = mesh.triangles[t][k];
      if (here > rank[v]) {
        rank[v] = here;
        result.value[v] = at_corner[t][k];
      } else if (here == 2 && result.value[v] != at_corner[t][k])
        result.agree = false;
    }
  }
  return result;
}

}  // namespace geo
