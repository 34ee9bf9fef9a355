// Checks of surfaces and complexes: each names the first offending ids. Exact (CGAL) where it is about geometry.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kerf/complex.h"
#include "kerf/mesh.h"

namespace geo {

struct SurfaceReport {
  bool closed = true, manifold = true, oriented = true;
  std::size_t degenerate_faces = 0;               ///< zero area, exactly
  std::optional<std::size_t> self_intersections;  ///< pairs; empty: not asked for
  std::string first_problem;                      ///< empty when all is well; names rows
  bool good() const { return first_problem.empty(); }
};

/// Checks a plain mesh, or the derived surface of a two-sided one as a mesh (collocated sheets are then no
/// intersection: the complex is tested, with each crack face once).
SurfaceReport check_surface(const TriangleMesh& mesh, bool self_intersections);

/// Checks K: structure (rings list their edges' faces as they stand, and material sides agree), derived surface closed,
/// oriented, manifold, no face without area, and with `self_intersections` no two faces crossing or overlapping,
/// exactly.
SurfaceReport check_complex(const Complex& complex, bool self_intersections);

/// The structural part of check_complex() for some faces (dead ones are skipped) and those that share a corner with
/// them: all that a step with these new faces can have broken. Cost follows the faces.
SurfaceReport check_near(const Complex& complex, std::span<const FaceId> faces);

/// True when two triangles, given by vertex ids and points, meet other than in the vertices and edges they share by id.
/// Exact. True also where one of them names a vertex twice that they share.
bool faces_cross(const std::array<std::uint32_t, 3>& f, const std::array<Vec3, 3>& p,
                 const std::array<std::uint32_t, 3>& g, const std::array<Vec3, 3>& q);

/// True when the half-planes from line ab through the points stand counter-clockwise about a→b, each strictly after the
/// one before it. Exact.
bool stand_around(const Vec3& a, const Vec3& b, std::span<const Vec3> through);

/// Pairs of faces of K that meet other than in shared vertices and edges; only pairs with a face in `only`, where
/// given.
std::vector<std::pair<FaceId, FaceId>> self_intersections(const Complex& complex,
                                                          const std::vector<FaceId>* only = nullptr);

/// Throws InputError unless `mesh` is a valid model: closed, manifold, oriented outwards, no degenerate or
/// self-intersecting triangles, finite coordinates. The message names the first offending rows and what to do.
void require_solid(const TriangleMesh& mesh);

}  // namespace geo
