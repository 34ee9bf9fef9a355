// find_bonds() and make_chunks() of kerf/pieces.h.
//
// A bond sums its crack faces, weighted by area. Texture coordinates of inner faces project onto
// the bond's mean plane; u is reversed on the far side, so that no side shows a mirrored texture.
#include "kerf/pieces.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/LU>

#include "kerf/parallel.h"
#include "surface/piece_sides.h"

namespace geo {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

// The crack faces between two pieces. Sums over faces, weighted by area.
struct Wall {
  double area = 0;
  Vec3 normal = Vec3::Zero(), center = Vec3::Zero();
};

// The walls by the pieces on their sides, the lower one first; a crack inside one piece has that
// piece twice. Deformed faces lie half way between their sides, and keep their undeformed weight.
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

// For each wall between two pieces the elastic section modulus of its projection to its mean plane.
// A moment m (unit vector) stresses a point x of the section by n × m · J⁻¹ x, J = ∫ x xᵀ dA
// (unsymmetric bending, Euler and Bernoulli). The greatest stress of all is max |J⁻¹ x|.
std::map<Pair, double> sections_of(const Complex& complex, const Pieces& pieces, const std::map<Pair, Wall>& walls) {
  struct Section {
    Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
    std::vector<Vec2> points;
  };
  std::map<Pair, Section> sections;
  for (std::uint32_t f = 0; f < complex.face_count(); ++f) {
    if (!complex.alive(FaceId(f)) || complex.face(FaceId(f)).crack == 0) continue;
    const Pair pair = std::minmax(static_cast<std::uint32_t>(pieces.of_side[f * 2]),
                                  static_cast<std::uint32_t>(pieces.of_side[f * 2 + 1]));
    if (pair.first == pair.second) continue;
    const Wall& wall = walls.at(pair);
    const Vec3 normal = wall.normal.norm() > 0 ? wall.normal.normalized() : Vec3(Vec3::UnitZ()),
               center = wall.center / wall.area, u = normal.unitOrthogonal(), v = normal.cross(u);
    const auto c = complex.corners(FaceId(f));
    const double area = 0.5 * (c[1] - c[0]).cross(c[2] - c[0]).norm();
    Section& section = sections[pair];
    Vec2 sum = Vec2::Zero();
    for (const Vec3& p : c) {
      const Vec2 x(u.dot(p - center), v.dot(p - center));
      section.second += area / 12 * x * x.transpose();
      section.points.push_back(x);
      sum += x;
    }
    section.second += area / 12 * sum * sum.transpose();
  }
  std::map<Pair, double> result;
  for (const auto& [pair, section] : sections) {
    double most = 0;
    const Eigen::Matrix2d inverse = section.second.inverse();
    for (const Vec2& x : section.points) most = std::max(most, (inverse * x).norm());
    result[pair] = most > 0 && std::isfinite(most) ? 1 / most : 0;
  }
  return result;
}

// The wall of a triangle of a piece, and whether the piece is on the wall's far side.
struct WallSide {
  const Wall* wall = nullptr;  // null: skin
  bool flipped = false;
};

// The walls of the triangles of each piece, in the order of piece_mesh().
std::vector<std::vector<WallSide>> walls_by_triangle(const Complex& complex, const Pieces& pieces,
                                                     const std::map<Pair, Wall>& walls) {
  std::vector<std::vector<WallSide>> result(pieces.count);
  for (std::uint32_t f = 0; f < complex.face_count(); ++f)
    for (std::uint32_t which = 0; which < 2; ++which) {
      const auto piece = pieces.of_side[f * 2 + which];
      if (piece < 0) continue;
      const bool crack = complex.face(FaceId(f)).crack > 0;
      const auto other = crack ? pieces.of_side[f * 2 + 1 - which] : piece;
      result[std::size_t(piece)].push_back(
          {crack ? &walls.at(std::minmax(std::uint32_t(piece), std::uint32_t(other))) : nullptr,
           other < piece || (other == piece && which == 1)});
    }
  return result;
}

// Gives a piece groups and texture coordinates where it has none.
void complete_attributes(TriangleMesh& mesh, const std::vector<WallSide>& walls, double tile) {
  Attributes& a = mesh.attributes;
  if (a.group.empty()) {
    a.group_names = {"skin", crack_group};
    for (const auto patch : mesh.patch) a.group.push_back(patch != 0);
  }
  if (a.uv.empty()) a.uv.assign(mesh.triangles.size(), {Vec2::Zero(), Vec2::Zero(), Vec2::Zero()});
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [wall, flipped] = walls[t];
    if (!wall || !std::all_of(a.uv[t].begin(), a.uv[t].end(), [](const Vec2& uv) { return uv.isZero(0); })) continue;
    const Vec3 n = wall->normal.norm() > 0 ? wall->normal.normalized() : Vec3::UnitZ();
    const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& q = mesh.vertices[mesh.triangles[t][k]];
      a.uv[t][k] = Vec2((flipped ? -u : u).dot(q), v.dot(q)) / tile;
    }
  }
}

}  // namespace

std::vector<Bond> find_bonds(const Complex& complex, const Pieces& pieces, std::span<const Vec3> moved) {
  const auto walls = walls_of(complex, pieces, moved);
  const auto sections = sections_of(complex, pieces, moved.empty() ? walls : walls_of(complex, pieces));
  std::vector<Bond> bonds;
  for (const auto& [pair, wall] : walls)
    if (pair.first != pair.second)
      bonds.push_back({.a = pair.first,
                       .b = pair.second,
                       .area = wall.area,
                       .normal = wall.normal.normalized(),
                       .centroid = wall.center / wall.area,
                       .section = sections.at(pair)});
  return bonds;
}

std::vector<Chunk> make_chunks(const Complex& complex, const Pieces& pieces, const TriangleMesh& original, double tile,
                               std::span<const Vec3> moved) {
  const auto walls = walls_of(complex, pieces);
  const auto wall_at = walls_by_triangle(complex, pieces, walls);
  const auto sides = sides_by_piece(pieces);
  std::vector<Chunk> chunks(pieces.count);
  // A share of pieces has one scratch memory.
  parallel_for(chunks.size(), 16, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> index(complex.surface_vertex_count(), ~0u);
    std::vector<SurfaceVertexId> vertex_of;
    for (std::size_t p = begin; p < end; ++p) {
      Chunk& chunk = chunks[p];
      chunk = {mesh_of_sides(complex, sides[p], index, vertex_of), pieces.volume[p], Vec3::Zero()};
      TriangleMesh& mesh = chunk.mesh;
      if (!original.triangles.empty()) transfer_attributes(original, mesh);
      mesh.site.clear();
      complete_attributes(mesh, wall_at[p], tile);
      if (!moved.empty()) {
        for (std::size_t v = 0; v < vertex_of.size(); ++v) mesh.vertices[v] = moved[vertex_of[v].index()];
        chunk.volume = signed_volume(mesh);
      }
      chunk.centroid = mass_properties(mesh).centroid;
    }
  });
  return chunks;
}

}  // namespace geo
