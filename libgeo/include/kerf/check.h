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

// ---- Shells: the connected parts of a closed surface

/// The role of a shell, by the number of shells around it and by its orientation.
enum class ShellKind : std::uint8_t {
  outer,     ///< outwards, around material: the outside of a solid, or of a core in a cavity
  cavity,    ///< inwards, in material
  inverted,  ///< inwards, but not in material: a solid that is inside out
  hidden,    ///< outwards, but in material: a hidden part, or a cavity that is oriented like the outside
};

/// A connected part of a closed surface.
struct Shell {
  std::uint32_t first_triangle = 0;  ///< the lowest index
  std::uint32_t triangles = 0;       ///< how many it has
  std::uint32_t parent = ~0u;        ///< the innermost shell around it; ~0u: none
  std::uint32_t depth = 0;           ///< number of shells around it
  bool outwards = true;              ///< whether its own enclosed volume is positive, exactly
  ShellKind kind = ShellKind::outer;
  /// Whether the orientation fits the place.
  bool well_oriented() const { return kind == ShellKind::outer || kind == ShellKind::cavity; }
};

/// The shells of a surface, by their first triangles. Precondition: it is closed, manifold,
/// oriented and free of crossings. Nesting and orientation are exact. Cost: n log n for shells
/// beside each other.
std::vector<Shell> find_shells(const TriangleMesh& mesh);

/// Whether a check looks for faces that cross or overlap, which costs more than all else.
enum class SelfIntersections : std::uint8_t { ignore, find };

/// The result of check_surface() and check_complex().
struct SurfaceReport {
  /// closed: no edge with one triangle; manifold: none with more than two, and all triangles at a
  /// vertex are joined across edges there; oriented: the two triangles of each edge run along it in
  /// opposite directions.
  bool closed = true, manifold = true, oriented = true;
  std::size_t degenerate_faces = 0;               ///< faces of zero area, exactly
  std::optional<std::size_t> self_intersections;  ///< pairs of faces; empty: not tested
  std::vector<Shell> shells;                      ///< of the skin; empty: not tested, as without a test for crossings
  std::string first_problem;                      ///< names indices; empty for a valid surface
  /// True without a problem.
  bool good() const { return first_problem.empty(); }
};

/// Checks a mesh. A two-sided surface is checked as a crack complex, each crack face once, so that
/// coincident sheets are no intersection.
/// \param crossings  find: also self-intersections and, where there are none, the orientation of
///   each shell: outwards, or inwards in the material of another one
/// \return a report that names the first problem; nothing is thrown
SurfaceReport check_surface(const TriangleMesh& mesh, SelfIntersections crossings);

/// Checks K: radial cycles list their edges' faces in geometric order; both sides of each wedge are
/// material, or both air; the derived surface is closed, oriented and manifold; no face is
/// degenerate. Exact.
/// \param crossings  find: also that no two faces cross or overlap, and that the shells of the skin
///   are oriented as check_surface() says
/// \return a report that names the first problem; nothing is thrown
SurfaceReport check_complex(const Complex& complex, SelfIntersections crossings);

/// The structural part of check_complex() for some faces (dead ones are skipped) and the faces that
/// share a corner with them. A step with these new faces can break nothing else. Cost follows the
/// faces.
SurfaceReport check_near(const Complex& complex, std::span<const FaceId> faces);

/// Pairs of faces of K that meet other than in shared vertices and edges; with `only`, pairs with
/// at least one face of that list. Exact.
std::vector<std::pair<FaceId, FaceId>> self_intersections(const Complex& complex,
                                                          const std::vector<FaceId>* only = nullptr);

/// Checks that `mesh` is a valid model: closed, manifold, each shell oriented outwards or, as a
/// cavity, inwards, no degenerate or self-intersecting triangles, finite coordinates.
/// \throws InputError where it is not; the message names the first offending indices and the remedy
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
