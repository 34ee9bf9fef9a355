// Cells begin at edge √(2 area / triangles wanted), exact for a plane, and grow by 15 % until the
// surface has few enough triangles.
#include "view/shrink.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace view {
namespace {

using Cell = std::array<std::int64_t, 5>;

geo::TriangleMesh clustered(const geo::TriangleMesh& mesh, const std::vector<std::uint32_t>& piece,
                            const std::vector<std::int32_t>& sheet, double edge, std::vector<std::uint32_t>& kept) {
  const geo::Vec3 lo = geo::bounding_box(mesh).lo;
  std::map<Cell, std::uint32_t> rows;
  std::vector<std::uint32_t> row_of(mesh.vertices.size());
  geo::TriangleMesh result;
  kept.clear();
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const geo::Vec3 at = (mesh.vertices[v] - lo) / edge;
    const Cell cell{std::int64_t(at.x()), std::int64_t(at.y()), std::int64_t(at.z()), piece[v], sheet[v]};
    const auto [place, fresh] = rows.try_emplace(cell, static_cast<std::uint32_t>(kept.size()));
    if (fresh) {
      kept.push_back(v);
      result.vertices.push_back(mesh.vertices[v]);
    }
    row_of[v] = place->second;
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    const geo::Triangle now{row_of[a], row_of[b], row_of[c]};
    if (now[0] == now[1] || now[1] == now[2] || now[2] == now[0]) continue;
    result.triangles.push_back(now);
    if (!mesh.patch.empty()) result.patch.push_back(mesh.patch[t]);
  }
  return result;
}

}  // namespace

geo::TriangleMesh shrink(const geo::TriangleMesh& mesh, const std::vector<std::uint32_t>& piece, std::size_t most,
                         std::vector<std::uint32_t>& kept) {
  // A vertex of a crack sheet belongs to the sheet, also where it meets the skin.
  std::vector<std::int32_t> sheet(mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < mesh.patch.size(); ++t)
    if (mesh.patch[t] != 0)
      for (const auto v : mesh.triangles[t]) sheet[v] = mesh.patch[t];
  // For a plane, cells of this size give the wanted number of triangles. Other surfaces give more,
  // so the cells grow.
  const double size = geo::bounding_box(mesh).diagonal();
  double edge = std::max(std::sqrt(2 * geo::area(mesh) / double(std::max<std::size_t>(most, 4))), 1e-6 * size);
  for (;; edge *= 1.15) {
    auto result = clustered(mesh, piece, sheet, edge, kept);
    if (result.triangles.size() <= most || edge > size) return result;
  }
}

}  // namespace view
