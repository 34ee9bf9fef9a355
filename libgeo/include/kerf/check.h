// Validity of meshes and crack complexes. Geometric tests are exact; reports name the first
// offending ids.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kerf/complex.h"
#include "kerf/mesh.h"
#include "kerf/vec.h"

namespace geo {

struct SurfaceReport {
  /// closed: no edge with one triangle; manifold: none with more than two; oriented: the two
  /// triangles of each edge run along it in opposite directions.
  bool closed = true, manifold = true, oriented = true;
  std::size_t degenerate_faces = 0;               ///< faces of zero area, exactly
  std::optional<std::size_t> self_intersections;  ///< pairs of faces; empty: not tested
  std::string first_problem;                      ///< names indices; empty for a valid surface
  /// True without a problem.
  bool good() const { return first_problem.empty(); }
};

/// Checks a mesh. A two-sided surface is checked as a crack complex, each crack face once, so that
/// coincident sheets are no intersection.
SurfaceReport check_surface(const TriangleMesh& mesh, bool self_intersections);

/// Checks K: radial cycles list their edges' faces in geometric order; both sides of each wedge are
/// material, or both air; the derived surface is closed, oriented and manifold; no face is
/// degenerate. With `self_intersections`, also that no two faces cross or overlap. Exact.
SurfaceReport check_complex(const Complex& complex, bool self_intersections);

/// The structural part of check_complex() for some faces (dead ones are skipped) and the faces that
/// share a corner with them. A step with these new faces can break nothing else. Cost follows the
/// faces.
SurfaceReport check_near(const Complex& complex, std::span<const FaceId> faces);

/// Pairs of faces of K that meet other than in shared vertices and edges; with `only`, pairs with
/// at least one face of that list. Exact.
std::vector<std::pair<FaceId, FaceId>> self_intersections(const Complex& complex,
                                                          const std::vector<FaceId>* only = nullptr);

/// Throws InputError unless `mesh` is a valid model: closed, manifold, oriented outwards, no
/// degenerate or self-intersecting triangles, finite coordinates. The message names the first
/// offending indices and the remedy.
void require_solid(const TriangleMesh& mesh);

// ---- Predicates

/// True when two triangles, given by vertex ids f, g and points p, q, meet other than in vertices
/// and edges shared by id. Also true when a shared vertex occurs twice in one of them. Exact.
bool faces_cross(const std::array<std::uint32_t, 3>& f, const std::array<Vec3, 3>& p,
                 const std::array<std::uint32_t, 3>& g, const std::array<Vec3, 3>& q);

/// True when the half-planes from line ab through the points are in radial order: counter-clockwise
/// about a→b, each strictly after the one before it. Exact.
bool in_radial_order(const Vec3& a, const Vec3& b, std::span<const Vec3> through);

}  // namespace geo
