// What the readers and writers of surface formats share. Not part of the public interface.
#pragma once

#include <string>
#include <vector>

#include "kerf/mesh.h"
#include "kerf/surface_file.h"

namespace geo {

// One reader for each format: everything the file holds, and the name that complaints begin with.
SurfaceFile parse_surface_ply(const std::string& bytes, const std::string& name);
TriangleMesh parse_obj(const std::string& bytes, const std::string& name);
TriangleMesh parse_off(const std::string& bytes, const std::string& name);
TriangleMesh parse_stl(const std::string& bytes, const std::string& name);

/// A number as a row; ~0u when it is none.
inline std::uint32_t row_of(double x) {
  if (!(x >= 0 && x < 4294967295.0)) return ~0u;
  const auto row = static_cast<std::uint32_t>(x);
  return static_cast<double>(row) == x ? row : ~0u;
}

/// Adds a polygon of n corners as n − 2 triangles: 0, k, k + 1 for k = 1, 2 … unless these fold over, as of one that is
/// not convex. Returns the corners of each. Throws InputError, `where` first.
std::vector<std::array<std::uint32_t, 3>> add_polygon(TriangleMesh& mesh, const std::vector<std::uint32_t>& polygon,
                                                      const std::string& where);

/// Each vertex' value at all of its corners.
template <class V>
std::vector<std::array<V, 3>> at_corners(const TriangleMesh& mesh, const std::vector<V>& at_vertex) {
  std::vector<std::array<V, 3>> result;
  result.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) result.push_back({at_vertex[a], at_vertex[b], at_vertex[c]});
  return result;
}

/// The reverse, as far as it goes: what the first corner of each vertex has, corners on skin before those on cracks.
/// `agree`: all corners on skin have their vertex' value.
template <class V>
struct AtVertices {
  std::vector<V> value;
  bool agree = true;
};
template <class V>
AtVertices<V> at_vertices(const TriangleMesh& mesh, const std::vector<std::array<V, 3>>& at_corner) {
  AtVertices<V> result;
  result.value.assign(mesh.vertices.size(), V::Zero());
  std::vector<char> rank(mesh.vertices.size(), 0);  // 1: from a crack, 2: from the skin
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const char here = mesh.patch.empty() || mesh.patch[t] == 0 ? 2 : 1;
    for (int k = 0; k < 3; ++k) {
      const auto v = mesh.triangles[t][k];
      if (here > rank[v])
        rank[v] = here, result.value[v] = at_corner[t][k];
      else if (here == 2 && result.value[v] != at_corner[t][k])
        result.agree = false;
    }
  }
  return result;
}

}  // namespace geo
