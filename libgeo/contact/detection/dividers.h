// Planes between parts of triangles: while every vertex stays on its side of them, nothing can cross, whatever each one
// does.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "contact/detection/simplex.h"
#include "kerf/mesh.h"

namespace geo {

/// What may be near each other, and where it wants to be. Rows of vertices are those that stand for others
/// (vertices_together()).
struct Divided {
  const std::vector<Triangle>& triangles;                          ///< of such rows
  std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs;  ///< of triangles; no others come together
  const std::vector<Vec3>& to;
  const std::vector<double>& limit;  ///< per row: how far it may go at most
  double gap = 0;                    ///< that sheets in contact keep
};

/// Moves rows of `at`, where no two triangles cross, towards where they want to be: each as far as all planes between
/// it and what is near let it, sliding along them. A plane stands across the closest places of two parts, where both
/// want it most. What comes out crosses nowhere: a vertex's planes do not depend on where others go. Floating point,
/// with half the gap to spare; parts that are so near that rounding counts stay where they are. Returns the number of
/// planes.
std::size_t move_divided(const Divided& d, std::vector<Vec3>& at);

/// The parts of two triangles that must not meet: none has a corner of the other. Returns how many couples, at most 2.
int parts_apart(const Triangle& s, const Triangle& t, std::pair<Simplex, Simplex> (&parts)[2]);

}  // namespace geo
