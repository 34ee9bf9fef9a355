// Score, cut, pieces and checks, all in memory. Faces of a piece are in the order of piece_mesh().
#include "dataset/fracture.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Geometry>

#include <kerf/check.h>
#include <kerf/crack.h>
#include <kerf/error.h>
#include "model.h"
#include "tool.h"

namespace dataset {
namespace {

constexpr double volume_tolerance = 1e-9;  // relative to the model's volume

// Bond between two pieces as a label.
using Labels = std::map<std::pair<std::uint32_t, std::uint32_t>, std::int32_t>;

Labels labels_of(const std::vector<geo::Bond>& bonds) {
  Labels labels;
  for (std::size_t k = 0; k < bonds.size(); ++k) labels[{bonds[k].a, bonds[k].b}] = static_cast<std::int32_t>(k + 1);
  return labels;
}

std::string name_of(std::size_t piece) { return "piece " + std::to_string(piece); }

}  // namespace

Model read_model(const std::string& path, const std::string& name, bool repair, const tool::Say& say) {
  geo::SurfaceFile file = tool::read_solid(path, repair, say);
  tool::require_whole(file.mesh, path, "give the model before the cut");
  file.mesh.attributes = {};
  file.mesh.source.clear();
  Model model{.name = name, .mesh = {}, .complex = tool::complex_of(file, path), .volume = 0};
  model.volume = geo::signed_volume(file.mesh);
  model.mesh = std::move(file.mesh);
  return model;
}

namespace {

// The closed boundary of each piece, with labels: the sides of all faces, in their order.
std::vector<Piece> pieces_of(const geo::Complex& complex, const geo::Pieces& found, const Labels& labels) {
  std::vector<Piece> pieces(found.count);
  std::vector<std::uint32_t> index(complex.surface_vertex_count(), ~0u);  // in its piece: no vertex of S_A has two
  for (std::uint32_t f = 0; f < complex.face_count(); ++f)
    for (std::uint32_t which = 0; which < 2; ++which) {
      const auto number = found.of_side[2 * f + which];
      if (number < 0) continue;
      const geo::Side side{geo::FaceId(f), static_cast<int>(which)};
      const auto& face = complex.face(side.face);
      Piece& piece = pieces[static_cast<std::size_t>(number)];
      geo::Triangle t;
      for (int c = 0; c < 3; ++c) {
        const auto v = complex.surface_vertex(side, c);
        auto& row = index[v.index()];
        if (row == ~0u) {
          row = static_cast<std::uint32_t>(piece.vertices.size());
          piece.vertices.push_back(complex.point(complex.site(v)));
        }
        t[static_cast<std::size_t>(c)] = row;
      }
      if (which == 1) std::swap(t[1], t[2]);
      piece.faces.push_back(t);
      piece.source.push_back(face.crack == 0 ? face.source : ~0u);
      if (face.crack == 0) {
        piece.label.push_back(skin);
        continue;
      }
      const auto self = static_cast<std::uint32_t>(number),
                 other = static_cast<std::uint32_t>(found.of_side[2 * f + 1 - which]);
      const auto label = labels.find(std::minmax(self, other));
      if (label == labels.end())
        throw geo::GeometryError(name_of(self) + " has an internal face: a crack ends inside it");
      piece.label.push_back(label->second);
    }
  return pieces;
}

void measure_and_check(Fracture& fracture, double volume) {
  geo::TriangleMesh mesh;
  double sum = 0, compensation = 0;  // Kahan summation
  for (std::size_t p = 0; p < fracture.pieces.size(); ++p) {
    Piece& piece = fracture.pieces[p];
    mesh.vertices.swap(piece.vertices);
    mesh.triangles.swap(piece.faces);
    const auto report = geo::check_surface(mesh, geo::SelfIntersections::ignore);
    if (!report.good()) throw geo::GeometryError(name_of(p) + ": " + report.first_problem);
    piece.volume = geo::signed_volume(mesh);
    piece.centroid = geo::mass_properties(mesh).centroid;
    mesh.vertices.swap(piece.vertices);
    mesh.triangles.swap(piece.faces);
    if (!(piece.volume > 0)) throw geo::GeometryError(name_of(p) + " has no volume");
    const double y = piece.volume - compensation, t = sum + y;
    compensation = (t - sum) - y;
    sum = t;
  }
  if (!(std::abs(sum - volume) <= volume_tolerance * volume))
    throw geo::GeometryError("volumes of pieces sum to " + tool::number(sum) + ", not to " + tool::number(volume));
}

// The faces on both sides of each wall, in the order of the complex. Faces of pieces are in that
// order, too.
std::vector<std::vector<WallFaces>> walls_of(const geo::Complex& complex, const geo::Pieces& found,
                                             const Labels& labels) {
  std::vector<std::vector<WallFaces>> walls(labels.size());
  std::vector<std::uint32_t> rows(found.count);  // faces of each piece so far
  for (std::uint32_t f = 0; f < complex.face_count(); ++f) {
    const std::int32_t front = found.of_side[2 * f];
    const std::int32_t back = found.of_side[2 * f + 1];
    const std::uint32_t front_row = front < 0 ? 0 : rows[static_cast<std::size_t>(front)]++;
    const std::uint32_t back_row = back < 0 ? 0 : rows[static_cast<std::size_t>(back)]++;
    if (front < 0 || back < 0 || complex.face(geo::FaceId(f)).crack == 0) continue;
    const auto a = static_cast<std::uint32_t>(std::min(front, back));
    const auto b = static_cast<std::uint32_t>(std::max(front, back));
    const auto label = static_cast<std::size_t>(labels.at({a, b}));
    walls[label - 1].push_back(front < back ? WallFaces{front_row, back_row} : WallFaces{back_row, front_row});
  }
  return walls;
}

}  // namespace

Fracture break_model(const Model& model, const Recipe& recipe) {
  geo::Complex cut;
  const geo::Score score = geo::make_score(model.complex, score_options(recipe), {}, &cut);
  const geo::Pieces found = geo::find_pieces(cut);
  Fracture fracture{.recipe = recipe, .pieces = {}, .bonds = geo::find_bonds(cut, found), .walls = {}};
  const Labels labels = labels_of(fracture.bonds);
  fracture.pieces = pieces_of(cut, found, labels);
  fracture.walls = walls_of(cut, found, labels);
  measure_and_check(fracture, model.volume);
  return fracture;
}

void pose(Fracture& fracture) {
  for (std::uint32_t p = 0; p < fracture.pieces.size(); ++p) {
    Piece& piece = fracture.pieces[p];
    piece.rotation = random_rotation(fracture.recipe.seed, p);
    piece.translation = piece.centroid;
    const auto& [w, x, y, z] = piece.rotation;
    const geo::Mat3 back = Eigen::Quaterniond(w, x, y, z).toRotationMatrix();
    for (geo::Vec3& v : piece.vertices) v = back.transpose() * (v - piece.centroid);
  }
}

}  // namespace dataset
