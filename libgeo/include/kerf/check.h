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
/// coincident sheets are no intersection. With `self_intersections`, and where there are none, also
/// the orientation of each shell: outwards, or inwards in the material of another one.
SurfaceReport check_surface(const TriangleMesh& mesh, bool self_intersections);

/// Checks K: radial cycles list their edges' faces in geometric order; both sides of each wedge are
/// material, or both air; the derived surface is closed, oriented and manifold; no face is
/// degenerate. With `self_intersections`, also that no two faces cross or overlap, and that the
/// shells of the skin are oriented as check_surface() says. Exact.
SurfaceReport check_complex(const Complex& complex, bool self_intersections);

/// The structural part of check_complex() for some faces (dead ones are skipped) and the faces that
/// share a corner with them. A step with these new faces can break nothing else. Cost follows the
/// faces.
SurfaceReport check_near(const Complex& complex, std::span<const FaceId> faces);

/// Pairs of faces of K that meet other than in shared vertices and edges; with `only`, pairs with
/// at least one face of that list. Exact.
std::vector<std::pair<FaceId, FaceId>> self_intersections(const Complex& complex,
                                                          const std::vector<FaceId>* only = nullptr);

/// Throws InputError unless `mesh` is a valid model: closed, manifold, each shell oriented outwards
/// or, as a cavity, inwards, no degenerate or self-intersecting triangles, finite coordinates. The
/// message names the first offending indices and the remedy.
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

/// The treatment of shells that lie in the material of others.
enum class InnerShells {
  by_orientation,  ///< one oriented against its surroundings is a cavity, one oriented like them is left out
  cavities,        ///< each is a cavity, and a shell in a cavity is a core
  filled,          ///< all are left out
};

/// Options of repair().
struct RepairOptions {
  double weld_distance = 0;  ///< open vertices up to this far apart are welded, model units
  bool smooth_fill = false;  ///< holes are closed by fair patches where these cross nothing
  InnerShells inner = InnerShells::by_orientation;
};

/// The changes that repair() made, in its order.
struct RepairStats {
  std::size_t welded_vertices = 0;    ///< vertices merged into others
  std::size_t dropped_triangles = 0;  ///< degenerate (a vertex twice) or duplicate
  std::size_t flipped_triangles = 0;  ///< orientation reversed in the result
  std::size_t filled_holes = 0;
  std::size_t added_triangles = 0;  ///< in holes
  std::size_t smooth_fills = 0;     ///< holes that are filled by fair patches
  std::size_t inverted_shells = 0;  ///< shells whose orientation was reversed, those of hollowed_shells not counted
  std::size_t dropped_shells = 0;   ///< shells in material, oriented like it, that were left out
  std::size_t hollowed_shells = 0;  ///< shells in material, oriented like it, that became cavities or cores
  std::size_t filled_shells = 0;    ///< further inner shells that InnerShells::filled left out
  /// True when the mesh is as it was.
  bool nothing() const {
    return welded_vertices + dropped_triangles + flipped_triangles + filled_holes + dropped_shells + filled_shells == 0;
  }
};

/// Repairs the topology of a plain mesh (no sites), in this order: welds seams, open ones also
/// where their vertices are up to weld_distance apart (model units); drops triangles that bound
/// nothing; orients neighbours alike; fills each hole by triangles between its corners, or, with
/// smooth_fill and where nothing crosses, by a fair patch that continues the surface around it;
/// turns shells outwards, cavities inwards, and treats shells in material as options.inner says;
/// drops vertices without triangles.
///
/// Which inner shells are cavities follows from the winding number. Relative to the orientation of
/// the outermost shell, an inner one adds 1 or takes 1 away, and material is where the sum is above
/// 0. So repair() and self_union() decide alike.
///
/// Attributes stay with their triangles; a filled hole has those of its rim. Intersecting triangles
/// and edges of more than two triangles remain: check_surface() finds them.
RepairStats repair(TriangleMesh& mesh, const RepairOptions& options = {});

// ---- Open sheets: parts of a surface that bound nothing

/// The meaning of parts with open edges.
enum class OpenParts {
  by_area,  ///< open sheets where closing their holes takes half their area, or where a rim is no loop
  closed,   ///< surfaces with holes
  sheets,   ///< open sheets
};

/// The changes that take_sheets() made.
struct OpenSheetStats {
  std::size_t welded_vertices = 0;    ///< vertices merged into others
  std::size_t dropped_triangles = 0;  ///< degenerate, duplicate, or walls between two parts
  std::size_t sheets = 0;             ///< parts taken out
};

/// Takes the open sheets out of a plain mesh and returns them, on the same vertices. Before, it
/// welds seams as repair() does. Where two triangles coincide and face each other, as in a
/// double-sided card, one stays. Parts are joined across edges of two triangles. A part of a sphere
/// is taken for a sheet where it is smaller than a half: closing it takes more than half of its
/// area.
TriangleMesh take_sheets(TriangleMesh& mesh, double weld_distance = 0, OpenParts open = OpenParts::by_area,
                         OpenSheetStats* stats = nullptr);

}  // namespace geo
