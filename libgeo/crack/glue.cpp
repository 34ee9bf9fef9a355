// Functions of kerf/glue.h.
#include "kerf/glue.h"

#include <iterator>
#include <map>
#include <unordered_map>
#include <utility>

#include "kerf/hierarchy.h"
#include "kerf/pieces.h"

namespace geo {
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

namespace {

// Appends bonds by their cells, measured.
void append(std::map<std::pair<std::uint32_t, std::uint32_t>, GluedBond>& bonds, GluedBonds& glued) {
  for (auto& [cells, bond] : bonds) {
    bond.a = cells.first;
    bond.b = cells.second;
    measure(bond, glued.points);
    glued.bonds.push_back(std::move(bond));
  }
}

}  // namespace

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
  append(bonds, glued);
  if (!edit.empty()) complex.apply(edit);
  return std::move(pieces.volume);
}

void join_small_cells(GluedBonds& glued, std::size_t first, std::span<const double> volumes, double least) {
  std::vector<GluedBond> before(std::make_move_iterator(glued.bonds.begin() + static_cast<std::ptrdiff_t>(first)),
                                std::make_move_iterator(glued.bonds.end()));
  glued.bonds.resize(first);
  std::vector<Bond> between;
  for (const GluedBond& bond : before)
    if (bond.a != bond.b) between.push_back({.a = bond.a, .b = bond.b, .area = bond.area});
  const std::vector<std::uint32_t> group = join_small_pieces(volumes, between, least);
  std::map<std::pair<std::uint32_t, std::uint32_t>, GluedBond> bonds;
  for (GluedBond& bond : before) {
    const auto a = group[bond.a], b = group[bond.b];
    if (a == b && bond.a != bond.b) continue;
    // Faces of a bond run from its lower cell to its higher one.
    if (a > b)
      for (Triangle& face : bond.faces) std::swap(face[1], face[2]);
    GluedBond& joined = bonds[std::minmax(a, b)];
    joined.faces.insert(joined.faces.end(), bond.faces.begin(), bond.faces.end());
  }
  append(bonds, glued);
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
