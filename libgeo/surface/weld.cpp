// Union-find over vertices at open edges: equal positions are adjacent after sorting; positions
// within `reach` are found in a grid of cells of that size, in 27 cells each.
#include "surface/weld.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "base/union_find.h"

namespace geo {
namespace {

// The vertices at edges with a single triangle, ascending.
std::vector<std::uint32_t> open_vertices(const TriangleMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) edges.push_back(std::minmax({t[k], t[(k + 1) % 3]}));
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint32_t> open;
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if (end - i == 1) {
      open.push_back(edges[i].first);
      open.push_back(edges[i].second);
    }
  }
  std::sort(open.begin(), open.end());
  open.erase(std::unique(open.begin(), open.end()), open.end());
  return open;
}

void join_near(const TriangleMesh& mesh, const std::vector<std::uint32_t>& open, double reach, UnionFind& joined) {
  std::map<std::array<double, 3>, std::vector<std::uint32_t>> cells;  // with edges of length reach
  for (const auto v : open) {
    const Vec3& p = mesh.vertices[v];
    const Vec3 cell = (p / reach).array().floor();
    for (int i = 0; i < 27; ++i)
      if (const auto at = cells.find({cell.x() + i % 3 - 1, cell.y() + i / 3 % 3 - 1, cell.z() + i / 9 - 1});
          at != cells.end())
        for (const auto other : at->second)
          if ((mesh.vertices[other] - p).norm() <= reach) joined.unite(v, other);
    cells[{cell.x(), cell.y(), cell.z()}].push_back(v);
  }
}

}  // namespace

std::size_t weld_seams(TriangleMesh& mesh, double reach) {
  auto open = open_vertices(mesh);
  UnionFind joined(mesh.vertices.size());  // the vertex that each becomes
  const auto position = [&](std::uint32_t v) {
    return std::tie(mesh.vertices[v].x(), mesh.vertices[v].y(), mesh.vertices[v].z());
  };
  if (reach > 0) {
    join_near(mesh, open, reach, joined);
  } else {
    std::sort(open.begin(), open.end(), [&](std::uint32_t a, std::uint32_t b) { return position(a) < position(b); });
    for (std::size_t i = 1; i < open.size(); ++i)
      if (position(open[i]) == position(open[i - 1])) joined.unite(open[i], open[i - 1]);
  }
  std::vector<std::uint32_t> index(mesh.vertices.size());
  std::uint32_t count = 0;
  for (std::uint32_t v = 0; v < index.size(); ++v) {
    const auto first = joined.find(v);
    if (first == v) mesh.vertices[count] = mesh.vertices[v];
    index[v] = first == v ? count++ : index[first];
  }
  const std::size_t removed = mesh.vertices.size() - count;
  mesh.vertices.resize(count);
  for (auto& t : mesh.triangles)
    for (auto& v : t) v = index[v];
  return removed;
}

}  // namespace geo
