// One fracture: a model in pieces, each closed, with labels of its faces, and bonds between pieces.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <kerf/complex.h>
#include <kerf/pieces.h>
#include "dataset/recipe.h"
#include "model.h"

namespace dataset {

/// A model that was read, checked and indexed: the start of all its fractures.
struct Model {
  std::string name;
  geo::TriangleMesh mesh;
  geo::Complex complex;
  double volume = 0;
};

/// Label of a face: the skin, or bond k as k + 1.
constexpr std::int32_t skin = 0;

struct Piece {
  std::vector<geo::Vec3> vertices;
  std::vector<geo::Triangle> faces;
  std::vector<std::int32_t> label;    ///< per face
  std::vector<std::uint32_t> source;  ///< per face: triangle of the model; ~0u on cracks
  double volume = 0;
  geo::Vec3 centroid = geo::Vec3::Zero();      ///< of the material, in the whole model
  std::array<double, 4> rotation{1, 0, 0, 0};  ///< unit quaternion w, x, y, z, see pose()
  geo::Vec3 translation = geo::Vec3::Zero();
};

/// The two sides of a triangle of a wall: its row among the faces of the bond's first piece, and of
/// the second. Corners 0, 1, 2 of one are at the places of corners 0, 2, 1 of the other.
using WallFaces = std::array<std::uint32_t, 2>;

struct Fracture {
  Recipe recipe;
  std::vector<Piece> pieces;                  ///< in descending order of volume
  std::vector<geo::Bond> bonds;               ///< ordered by their pieces
  std::vector<std::vector<WallFaces>> walls;  ///< per bond: all triangles of its wall
};

/// Reads a model and makes its complex; `say` takes what a repair decided about shells. Throws
/// InputError where it is no solid, or cut.
Model read_model(const std::string& path, const std::string& name, bool repair, const tool::Say& say);

/// Breaks a model, and checks the result: every piece is closed and has a volume, volumes sum to
/// the model's within 1e-9 of it, every crack face lies between two pieces. Throws GeometryError
/// with the reason where a check fails or no pattern can be inserted.
Fracture break_model(const Model& model, const Recipe& recipe);

/// Rotates every piece at random about its centroid, which becomes the origin. A vertex p of the
/// model is then at R (p - centroid); back, it is Rᵀ q + centroid: `rotation` holds Rᵀ,
/// `translation` the centroid.
void pose(Fracture& fracture);

}  // namespace dataset
