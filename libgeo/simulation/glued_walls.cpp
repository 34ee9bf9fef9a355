// A wall is refined to the spacing of nodes, inserted as a crack, and taken out again.
#include "simulation/glued_walls.h"

#include <algorithm>
#include <cmath>

#include "geometry/bvh.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/score.h"
#include "score/jagged.h"
#include "score/patterns.h"
#include "simulation/bond_breaking.h"
#include "simulation/strength.h"

namespace geo {
namespace {

// Tessellations that are tried. One in some thousands cannot be inserted; another seed is another
// one.
constexpr int attempts = 4;

// Forgets the bonds from `first` on that are not in a body: walls may reach into others.
void keep_within(const TriangleBvh& body, std::size_t first, GluedBonds& glued) {
  const auto is_elsewhere = [&](const GluedBond& bond) {
    const auto& [a, b, c] = bond.faces.at(0);
    return !body.inside((glued.points[a] + glued.points[b] + glued.points[c]) / 3);
  };
  auto& bonds = glued.bonds;
  bonds.erase(std::remove_if(bonds.begin() + static_cast<std::ptrdiff_t>(first), bonds.end(), is_elsewhere),
              bonds.end());
}

// Glues walls whose triangles are small enough. Returns the volumes of cells.
std::vector<double> glue(const TriangleBvh& skin, const TriangleMesh& walls, std::int32_t crack, Complex& complex,
                         GluedBonds& glued) {
  const std::size_t first = glued.bonds.size();
  insert_sheet(complex, walls, crack);
  std::vector<double> volumes = glue_crack(complex, crack, glued);
  keep_within(skin, first, glued);
  return volumes;
}

}  // namespace

void glue_walls(const GluedBody& to, TriangleMesh walls, std::int32_t crack, Complex& complex, GluedBonds& glued) {
  const TriangleBvh skin(corners_of(to.model));
  const std::size_t first = glued.bonds.size();
  refine_walls(walls, skin, to.spacing, to.spacing);
  glue(skin, walls, crack, complex, glued);
  number_cells(glued, first);
  set_strength(glued, first, to.strength, to.seed, complex.extent().diagonal(), to.body);
}

void glue_cells(const GluedBody& to, const FractureOptions& fracture, std::int32_t crack, Complex& complex,
                GluedBonds& glued) {
  const Breakage& breakage = fracture.of_body(to.body);
  const TriangleBvh skin(corners_of(to.model));
  const std::size_t first = glued.bonds.size();
  for (int attempt = 0;; ++attempt) {
    PatternOptions pattern;
    pattern.seed = to.seed + static_cast<std::uint64_t>(attempt) * 0x9e3779b97f4a7c15ull;
    TriangleMesh walls = pattern_walls(skin, breakage.cells, pattern);
    refine_walls(walls, skin, to.spacing, to.spacing);
    if (breakage.jagged > 0)
      roughen_walls(walls, skin,
                    {.amplitude = breakage.jagged, .edge = to.spacing / skin.box().diagonal(), .seed = pattern.seed});
    try {
      const std::vector<double> volumes = glue(skin, walls, crack, complex, glued);
      join_small_cells(glued, first, volumes, to.spacing * to.spacing * to.spacing);
      break;
    } catch (const GeometryError&) {
      if (attempt + 1 == attempts) throw;
    }
  }
  auto& bonds = glued.bonds;
  bonds.erase(std::remove_if(bonds.begin() + static_cast<std::ptrdiff_t>(first), bonds.end(),
                             [&](const GluedBond& bond) { return !may_break(fracture, bond.centroid); }),
              bonds.end());
  Strength strength = to.strength;
  if (strength.toughness == 0) strength.toughness = strength.strength / stress_of_toughness(1, to.spacing);
  number_cells(glued, first);
  set_strength(glued, first, strength, to.seed, complex.extent().diagonal(), to.body);
}

}  // namespace geo
