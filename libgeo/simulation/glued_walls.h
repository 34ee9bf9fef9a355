// Walls that are glued before a run begins: those of a score, or of cells that are made for it.
#pragma once

#include <cstdint>

#include "kerf/complex.h"
#include "kerf/glue.h"
#include "kerf/mesh.h"
#include "kerf/scene.h"

namespace geo {

/// The body whose walls are glued.
struct GluedBody {
  const TriangleMesh& model;  ///< placed, without cracks
  std::uint32_t body;         ///< of the scene
  const Strength& strength;   ///< of its walls
  double spacing;             ///< of the nodes where they are finest: walls get triangles of that size
  std::uint64_t seed;         ///< of noise and cells
};

/// Inserts the outline of walls on the skin, and appends their bonds to `glued`. `crack`: a number
/// that the complex does not use. Throws as insert_sheet().
void glue_walls(const GluedBody& to, TriangleMesh walls, std::int32_t crack, Complex& complex, GluedBonds& glued);

/// The same for the walls of a random tessellation into about Breakage::cells cells. Cells smaller
/// than the material of a node are joined with a neighbour. Walls in boxes without fracture hold
/// for ever. Throws GeometryError where no tessellation can be inserted.
void glue_cells(const GluedBody& to, const FractureOptions& fracture, std::int32_t crack, Complex& complex,
                GluedBonds& glued);

}  // namespace geo
