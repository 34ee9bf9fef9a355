// Jagged walls: finer triangles, displaced by noise that depends on the place alone, so that walls that meet stay
// together.
#pragma once

#include "geometry/bvh.h"
#include "kerf/mesh.h"

namespace geo {

struct JaggedOptions {
  double amplitude = 0.02;  ///< of the largest bumps, relative to the diagonal of the model's box
  double frequency = 8;     ///< of these, per diagonal
  int octaves = 3;          ///< each twice as fine and 0.6 times as high
  double edge = 0;          ///< longest edge, relative; 0: an eighth of the largest bumps
  std::uint64_t seed = 1;
};

/// Divides edges, the longest first, until those near the material or inside are at most `longest` long (model units);
/// triangles farther outside than `margin` are dropped.
void refine_walls(TriangleMesh& walls, const TriangleBvh& skin, double longest, double margin);

/// Refines walls and displaces their points. Where they would cross each other they are displaced less, at last not at
/// all: walls that met in shared vertices and edges only still do. Throws InputError for options out of range.
void roughen_walls(TriangleMesh& walls, const TriangleBvh& skin, const JaggedOptions& options);

}  // namespace geo
