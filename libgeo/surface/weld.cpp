#include "surface/weld.h"

#include <algorithm>
#include <tuple>

namespace geo {
namespace {

// Vertices, ascending, that end an edge with one triangle only.
std::vector<std::uint32_t> open_vertices(const TriangleMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) edges.push_back(std::minmax({t[k], t[(k + 1) % 3]}));
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint32_t> open;
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if (end - i == 1) open.push_back(edges[i].first), open.push_back(edges[i].second);
  }
  std::sort(open.begin(), open.end());
  open.erase(std::unique(open.begin(), open.end()), open.end());
  return open;
}

}  // namespace

std::size_t weld_seams(TriangleMesh& mesh) {
  auto open = open_vertices(mesh);
  const auto place = [&](std::uint32_t v) { return std::tie(mesh.vertices[v].x(), mesh.vertices[v].y(), mesh.vertices[v].z()); };
  std::sort(open.begin(), open.end(), [&](std::uint32_t a, std::uint32_t b) { return std::make_tuple(place(a), a) < std::make_tuple(place(b), b); });
  std::vector<std::uint32_t> kept(mesh.vertices.size());  // whom each vertex becomes; first in old rows, then in new ones
  for (std::uint32_t v = 0; v < kept.size(); ++v) kept[v] = v;
  for (std::size_t i = 1; i < open.size(); ++i)
    if (place(open[i]) == place(open[i - 1])) kept[open[i]] = kept[open[i - 1]];
  std::uint32_t count = 0;
  for (std::uint32_t v = 0; v < kept.size(); ++v) {
    if (kept[v] != v) {
      kept[v] = kept[kept[v]];
      continue;
    }
    mesh.vertices[count] = mesh.vertices[v];
    kept[v] = count++;
  }
  const std::size_t gone = mesh.vertices.size() - count;
  mesh.vertices.resize(count);
  for (auto& t : mesh.triangles)
    for (auto& v : t) v = kept[v];
  return gone;
}

}  // namespace geo
