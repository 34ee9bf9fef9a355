// Glued scores: walls of a score whose two sides hold together until the load on them is too high.
// A glued wall is no crack yet. The complex has its outline on the skin and nothing else of it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "kerf/complex.h"
#include "kerf/crack.h"
#include "kerf/mesh.h"
#include "kerf/vec.h"

namespace geo {

/// Traction between the sides of a wall that has broken. It ends where the energy of the new
/// surfaces is spent.
struct Cohesion {
  std::int32_t crack = 0;       ///< number of the wall's faces in the complex; 0: there is no traction
  double peak = 0;              ///< Pa: the largest traction
  double opening = 0;           ///< of the sides, at which nothing holds, model units
  std::vector<double> reached;  ///< per face of the bond: the largest opening so far
  /// Whether any face holds.
  bool holds() const {
    return std::any_of(reached.begin(), reached.end(), [this](double r) { return r < opening; });
  }
};

/// The wall between two cells of a score, with what holds it. Cells are the pieces that the score
/// would make if it were cut.
struct GluedBond {
  std::vector<Triangle> faces;   ///< indices into GluedBonds::points; the normal points from cell a to cell b
  std::uint32_t a = 0, b = 0;    ///< cells; equal where a wall ends inside a cell
  std::uint32_t body = 0;        ///< body of the scene
  double area = 0;               ///< model units²
  Vec3 normal = Vec3::Zero();    ///< mean, a unit vector from a to b; zero where the faces close around one cell
  Vec3 centroid = Vec3::Zero();  ///< of the area
  double strength = 0;           ///< Pa: traction that breaks the bond
  double toughness = 0;          ///< Pa √m: at a broken neighbour, the bond breaks at this stress intensity; 0: never
  bool broken = false;           ///< its faces are crack faces of the complex
  Cohesion cohesion = {};        ///< of the broken wall
};

/// How often a time step may be halved at most while bonds break.
constexpr std::uint32_t max_halvings = 12;

/// The glued walls of a body.
struct GluedBonds {
  std::vector<Vec3> points;      ///< material coordinates; those on the skin are vertices of the complex
  std::vector<GluedBond> bonds;  ///< of all scores
  std::uint32_t halvings = 0;    ///< how often the time step is halved now, because bonds break
  std::uint32_t calm = 0;        ///< steps of this length since a bond has broken
};

/// Computes area, normal and centroid of a bond from its faces.
void measure(GluedBond& bond, const std::vector<Vec3>& points);

/// Takes the faces of crack `crack` out of the complex, and appends them to `glued` as bonds, one
/// for each pair of cells, ascending. Strength and toughness are left at zero. Vertices of the
/// outline stay. Returns the volumes of the cells, model units³.
std::vector<double> glue_crack(Complex& complex, std::int32_t crack, GluedBonds& glued);

/// Joins each cell smaller than `least`, the smallest first, with the neighbour that shares the
/// largest area with it: the bonds from `first` on between the two go. Bonds between the same cells
/// become one. `volumes`: of the cells, as glue_crack() gives them.
void join_small_cells(GluedBonds& glued, std::size_t first, std::span<const double> volumes, double least);

/// The faces of some bonds as one sheet for insert_sheet(). It meets the skin at vertices that the
/// complex has, so nothing is divided there unless a blade has passed since.
TriangleMesh sheet_of(const GluedBonds& glued, std::span<const std::uint32_t> bonds);

}  // namespace geo
