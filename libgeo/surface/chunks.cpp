#include "kerf/pieces.h"

#include <algorithm>
#include <map>

namespace geo {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

struct Wall {
  double area = 0;
  Vec3 normal = Vec3::Zero(), center = Vec3::Zero();  // not yet divided by what they weigh
};

// Cracks by the pieces on their sides, lower first; a crack inside of one piece has it twice. Where
// vertices have moved, a face is half way between its sides, and weighs what it did before.
std::map<Pair, Wall> walls_of(const Complex& complex, const Pieces& pieces, std::span<const Vec3> moved = {}) {
  std::map<Pair, Wall> walls;
  for (std::uint32_t f = 0; f < complex.face_count(); ++f) {
    if (!complex.alive(FaceId(f)) || complex.face(FaceId(f)).crack == 0) continue;
    const auto behind = static_cast<std::uint32_t>(pieces.of_side[f * 2]),
               before = static_cast<std::uint32_t>(pieces.of_side[f * 2 + 1]);
    auto c = complex.corners(FaceId(f));
    const auto normal = [&] { return Vec3(0.5 * (c[1] - c[0]).cross(c[2] - c[0])); };
    const double area = normal().norm();
    for (int k = 0; k < 3 && !moved.empty(); ++k)
      c[std::size_t(k)] = 0.5 * (moved[complex.surface_vertex({FaceId(f), 0}, k).index()] +
                                 moved[complex.surface_vertex({FaceId(f), 1}, k).index()]);
    Wall& wall = walls[std::minmax(behind, before)];
    wall.area += area;
    wall.normal += behind <= before ? normal() : Vec3(-normal());
    wall.center += area * (c[0] + c[1] + c[2]) / 3;
  }
  return walls;
}

Vec3 centroid_of(const TriangleMesh& mesh) {
  const Vec3 o = bounding_box(mesh).center();
  Vec3 sum = Vec3::Zero();
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 p = mesh.vertices[a] - o, q = mesh.vertices[b] - o, r = mesh.vertices[c] - o;
    const double v = p.dot(q.cross(r));
    volume += v, sum += v * (p + q + r) / 4;
  }
  return volume > 0 ? Vec3(o + sum / volume) : o;
}

}  // namespace

std::vector<Bond> find_bonds(const Complex& complex, const Pieces& pieces, std::span<const Vec3> moved) {
  std::vector<Bond> bonds;
  for (const auto& [pair, wall] : walls_of(complex, pieces, moved))
    if (pair.first != pair.second)
      bonds.push_back({pair.first, pair.second, wall.area, wall.normal.normalized(), wall.center / wall.area});
  return bonds;
}

std::vector<Chunk> make_chunks(const Complex& complex, const Pieces& pieces, const TriangleMesh& original, double tile,
                               std::span<const Vec3> moved) {
  const auto walls = walls_of(complex, pieces);
  // The walls that the triangles of each piece belong to, in the order in which piece_mesh() gives
  // them.
  std::vector<std::vector<std::pair<const Wall*, bool>>> wall_at(pieces.count);
  for (std::uint32_t f = 0; f < complex.face_count(); ++f)
    for (std::uint32_t which = 0; which < 2; ++which) {
      const auto piece = pieces.of_side[f * 2 + which];
      if (piece < 0) continue;
      const bool crack = complex.face(FaceId(f)).crack > 0;
      const auto other = crack ? pieces.of_side[f * 2 + 1 - which] : piece;
      wall_at[std::size_t(piece)].push_back(
          {crack ? &walls.at(std::minmax(std::uint32_t(piece), std::uint32_t(other))) : nullptr,
           other < piece || (other == piece && which == 1)});
    }
  std::vector<Chunk> chunks;
  std::vector<SurfaceVertexId> rows;
  for (std::uint32_t p = 0; p < pieces.count; ++p) {
    Chunk chunk{piece_mesh(complex, pieces, p, &rows), pieces.volume[p], Vec3::Zero()};
    TriangleMesh& mesh = chunk.mesh;
    if (!original.triangles.empty()) transfer_attributes(original, mesh);
    mesh.site.clear();
    Attributes& a = mesh.attributes;
    if (a.group.empty()) {
      a.group_names = {"skin", crack_group};
      for (const auto patch : mesh.patch) a.group.push_back(patch != 0);
    }
    if (a.uv.empty()) a.uv.assign(mesh.triangles.size(), {Vec2::Zero(), Vec2::Zero(), Vec2::Zero()});
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& [wall, turned] = wall_at[p][t];
      if (!wall || !std::all_of(a.uv[t].begin(), a.uv[t].end(), [](const Vec2& uv) { return uv.isZero(0); })) continue;
      const Vec3 n = wall->normal.norm() > 0 ? wall->normal.normalized() : Vec3::UnitZ();
      const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& q = mesh.vertices[mesh.triangles[t][k]];
        a.uv[t][k] = Vec2((turned ? -u : u).dot(q), v.dot(q)) / tile;
      }
    }
    if (!moved.empty()) {
      for (std::size_t v = 0; v < rows.size(); ++v) mesh.vertices[v] = moved[rows[v].index()];
      chunk.volume = signed_volume(mesh);
    }
    chunk.centroid = centroid_of(mesh);
    chunks.push_back(std::move(chunk));
  }
  return chunks;
}

}  // namespace geo
