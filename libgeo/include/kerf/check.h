// Validity of meshes and crack complexes, and repair of meshes. Geometric tests are exact; reports
// name the first offending ids.
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
  /// closed: no edge with one triangle; manifold: none with more than two, and all triangles at a
  /// vertex are joined across edges there; oriented: the two triangles of each edge run along it in
  /// opposite directions.
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

// ---- Repair: turns a surface that is nearly solid into a solid.

/// The changes that repair() made, in its order.
struct RepairStats {
  std::size_t welded_vertices = 0;    ///< vertices merged into others
  std::size_t dropped_triangles = 0;  ///< degenerate (a vertex twice) or duplicate
  std::size_t flipped_triangles = 0;  ///< orientation reversed in the result
  std::size_t filled_holes = 0;
  std::size_t added_triangles = 0;  ///< in holes
  std::size_t smooth_fills = 0;     ///< holes that are filled by fair patches
  std::size_t dropped_shells = 0;   ///< solid shells wholly inside another solid one
  /// True when the mesh is as it was.
  bool nothing() const {
    return welded_vertices + dropped_triangles + flipped_triangles + filled_holes + dropped_shells == 0;
  }
};

/// Repairs the topology of a plain mesh (no sites), in this order: welds seams, open ones also
/// where their vertices are up to `weld_distance` apart (model units); drops triangles that bound
/// nothing; orients neighbours alike; fills each hole by triangles between its corners, or, with
/// `smooth_fill` and where nothing crosses, by a fair patch that continues the surface around it;
/// turns shells outwards, cavities inwards; drops vertices without triangles.
///
/// Attributes stay with their triangles; a filled hole has those of its rim. Intersecting triangles
/// and edges of more than two triangles remain: check_surface() finds them.
RepairStats repair(TriangleMesh& mesh, double weld_distance = 0, bool smooth_fill = false);

}  // namespace geo
