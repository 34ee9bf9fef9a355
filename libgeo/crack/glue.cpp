// Functions of kerf/glue.h.
#include "kerf/glue.h"

#include <map>
#include <set>
#include <unordered_map>
#include <utility>

#include "kerf/pieces.h"

namespace geo {
namespace {

double area_of(const GluedBond& bond, const std::vector<Vec3>& points) {
  double area = 0;
  for (const auto& [a, b, c] : bond.faces) area += 0.5 * (points[b] - points[a]).cross(points[c] - points[a]).norm();
  return area;
}

}  // namespace

void measure(GluedBond& bond, const std::vector<Vec3>& points) {
  bond.area = 0;
  bond.normal = bond.centroid = Vec3::Zero();
  for (const Triangle& face : bond.faces) {
    const Vec3 &a = points[face[0]], &b = points[face[1]], &c = points[face[2]];
    const Vec3 normal = 0.5 * (b - a).cross(c - a);
    bond.area += normal.norm();
    bond.normal += normal;
    bond.centroid += normal.norm() * (a + b + c) / 3;
  }
  if (bond.area > 0) bond.centroid /= bond.area;
  bond.normal.stableNormalize();
}

std::vector<double> glue_crack(Complex& complex, std::int32_t crack, GluedBonds& glued) {
  Pieces pieces = find_pieces(complex);
  std::map<std::pair<std::uint32_t, std::uint32_t>, GluedBond> bonds;
  std::unordered_map<VertexId, std::uint32_t> index;
  ComplexEdit edit;
  for (std::uint32_t f = 0; f < complex.face_count(); ++f) {
    const FaceId id(f);
    if (!complex.alive(id) || complex.face(id).crack != crack) continue;
    edit.removed_faces.push_back(id);
    const auto behind = static_cast<std::uint32_t>(pieces.of_side[f * 2]);
    const auto before = static_cast<std::uint32_t>(pieces.of_side[f * 2 + 1]);
    GluedBond& bond = bonds[std::minmax(behind, before)];
    std::array<std::uint32_t, 3> v;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId at = complex.face(id).v[k];
      const auto [place, is_new] = index.try_emplace(at, static_cast<std::uint32_t>(glued.points.size()));
      if (is_new) glued.points.push_back(complex.point(at));
      v[k] = place->second;
    }
    if (behind > before) std::swap(v[1], v[2]);
    bond.faces.push_back({v[0], v[1], v[2]});
  }
  for (auto& [cells, bond] : bonds) {
    bond.a = cells.first;
    bond.b = cells.second;
    measure(bond, glued.points);
    glued.bonds.push_back(std::move(bond));
  }
  if (!edit.empty()) complex.apply(edit);
  return std::move(pieces.volume);
}

void join_small_cells(GluedBonds& glued, std::size_t first, std::vector<double> volumes, double least) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, GluedBond> bonds;
  for (std::size_t b = first; b < glued.bonds.size(); ++b)
    bonds[{glued.bonds[b].a, glued.bonds[b].b}] = std::move(glued.bonds[b]);
  std::vector<std::set<std::uint32_t>> neighbors(volumes.size());
  for (const auto& [cells, bond] : bonds) {
    if (cells.first == cells.second) continue;
    neighbors[cells.first].insert(cells.second);
    neighbors[cells.second].insert(cells.first);
  }
  // Faces of a bond run from its lower cell to its higher one.
  const auto rename = [&](std::uint32_t from, std::uint32_t to, std::uint32_t other) {
    GluedBond bond = std::move(bonds.extract(std::minmax(from, other)).mapped());
    if ((from < other) != (to < other))
      for (Triangle& face : bond.faces) std::swap(face[1], face[2]);
    GluedBond& joined = bonds[std::minmax(to, other)];
    joined.faces.insert(joined.faces.end(), bond.faces.begin(), bond.faces.end());
    neighbors[other].erase(from);
    neighbors[other].insert(to);
    neighbors[to].insert(other);
  };
  std::set<std::pair<double, std::uint32_t>> small;
  for (std::uint32_t cell = 0; cell < volumes.size(); ++cell)
    if (volumes[cell] < least && !neighbors[cell].empty()) small.insert({volumes[cell], cell});
  while (!small.empty()) {
    const std::uint32_t cell = small.extract(small.begin()).value().second;
    std::uint32_t into = cell;
    double largest = -1;
    for (const auto other : neighbors[cell]) {
      const double area = area_of(bonds.at(std::minmax(cell, other)), glued.points);
      if (area <= largest) continue;
      largest = area;
      into = other;
    }
    bonds.erase(std::minmax(cell, into));
    bonds.erase({cell, cell});
    neighbors[into].erase(cell);
    for (const auto other : neighbors[cell])
      if (other != into) rename(cell, into, other);
    small.erase({volumes[into], into});
    volumes[into] += volumes[cell];
    if (volumes[into] < least && !neighbors[into].empty()) small.insert({volumes[into], into});
  }
  glued.bonds.resize(first);
  for (auto& [cells, bond] : bonds) {
    bond.a = cells.first;
    bond.b = cells.second;
    measure(bond, glued.points);
    glued.bonds.push_back(std::move(bond));
  }
}

TriangleMesh sheet_of(const GluedBonds& glued, std::span<const std::uint32_t> bonds) {
  TriangleMesh sheet;
  std::unordered_map<std::uint32_t, std::uint32_t> index;
  for (const auto b : bonds)
    for (const Triangle& face : glued.bonds[b].faces) {
      Triangle t;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [place, is_new] = index.try_emplace(face[k], static_cast<std::uint32_t>(sheet.vertices.size()));
        if (is_new) sheet.vertices.push_back(glued.points[face[k]]);
        t[k] = place->second;
      }
      sheet.triangles.push_back(t);
    }
  return sheet;
}

}  // namespace geo
