// Repair: makes a solid of a surface that is none. Holes, seams, wrong orientation, parts that
// overlap or cross themselves, sheets without thickness.
//
// Three ways lead to a solid. repaired_solid() mends the triangles that are there. wrapped_solid()
// makes a new surface around them. repair(), take_sheets() and self_union() are their steps.
#pragma once

#include <cstddef>
#include <optional>

#include "kerf/mesh.h"
#include "kerf/progress.h"

namespace geo {

struct CrackOptions;  // kerf/crack.h

// ---- Topology: holes, seams, orientation

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
/// where their vertices are up to weld_distance apart; drops triangles that bound nothing; orients
/// neighbours alike; fills each hole by triangles between its corners, or, with smooth_fill and
/// where nothing crosses, by a fair patch that continues the surface around it; turns shells
/// outwards, cavities inwards, and treats shells in material as options.inner says; drops vertices
/// without triangles.
///
/// Which inner shells are cavities follows from the winding number. Relative to the orientation of
/// the outermost shell, an inner one adds 1 or takes 1 away, and material is where the sum is above
/// 0. So repair() and self_union() decide alike.
///
/// Attributes stay with their triangles; a filled hole has those of its rim. Intersecting triangles
/// and edges of more than two triangles remain: check_surface() finds them.
///
/// \param mesh  a plain mesh, changed in place
/// \param options  weld_distance is in model units
/// \return what was changed
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
/// is taken for a sheet where it is smaller than a half, because closing it takes more than half of
/// its area.
///
/// \param mesh  a plain mesh; it keeps the closed parts
/// \param weld_distance  open vertices up to this far apart are welded, model units
/// \param open  what parts with open edges are
/// \param stats  where given, receives the counts
/// \return the sheets
TriangleMesh take_sheets(TriangleMesh& mesh, double weld_distance = 0, OpenParts open = OpenParts::by_area,
                         OpenSheetStats* stats = nullptr);

// ---- Solids from surfaces that cross themselves

/// Statistics of self_union().
struct SelfUnionStats {
  std::size_t cells = 0;          ///< regions that the triangles enclose
  std::size_t removed_faces = 0;  ///< faces with material, or air, on both sides
};

/// The boundary of the points where the generalized winding number of `mesh` exceeds a half
/// (Jacobson, Kavan and Sorkine-Hornung 2013): one solid of parts that overlap, touch, cross
/// themselves or have walls inside. Any triangles will do, but open parts enclose nothing: fill
/// their holes first, see repair(). Triangles that cross nothing keep their vertices bit for bit;
/// attributes are interpolated over the triangles that contain the result's. Parts of the result
/// that touch in vertices or edges alone are moved apart there, by at most 2⁻¹² of an edge.
///
/// \param options  tolerances of the insertion, relative to the diagonal; `kerf/crack.h` has them
/// \param stats  where given, receives the counts
/// \throws InputError as insert_sheet(), and for a mesh without triangles
/// \throws GeometryError as insert_sheet(), where nothing is enclosed, and where touching parts
///   cannot be moved apart
TriangleMesh self_union(const TriangleMesh& mesh, const CrackOptions& options, SelfUnionStats* stats = nullptr);
/// The same with the default tolerances.
TriangleMesh self_union(const TriangleMesh& mesh, SelfUnionStats* stats = nullptr);

// ---- A solid in one call

/// The changes that repaired_solid() made.
struct SolidRepairStats {
  RepairStats repair;
  std::optional<SelfUnionStats> united;  ///< where triangles crossed, or edges had more than two
};

/// A valid model of a plain mesh (no sites): repair() with these options, then, where the result
/// is no solid, self_union().
///
/// \param options  of repair()
/// \param stats  where given, receives the counts
/// \throws InputError where triangles bound nothing, else as self_union()
TriangleMesh repaired_solid(TriangleMesh mesh, const RepairOptions& options = {}, SolidRepairStats* stats = nullptr);

/// Work of rounded_solid().
struct RoundingStats {
  std::size_t crossings = 0;  ///< pairs of triangles that crossed after the first rounding
  int rounds = 0;             ///< of dividing and rounding again; 0: rounding was enough
};

/// A valid model whose coordinates are in single precision, for files and programs that hold no
/// more; `source` is empty where triangles were divided. Rounding may make triangles cross or lose
/// their area: these are divided where they meet, united, and rounded again. Vertices move by a
/// float's distance at the largest coordinate, in later rounds near crossings by up to 2⁻¹³ of that
/// coordinate.
///
/// \param solid  a plain mesh, valid in double precision
/// \param stats  where given, receives the counts
/// \throws GeometryError where it is no solid after ten rounds, else as self_union()
TriangleMesh rounded_solid(const TriangleMesh& solid, RoundingStats* stats = nullptr);

/// A new surface around closed parts, which may intersect themselves and each other, and open
/// sheets, as take_sheets() tells them apart. Around closed parts it is the zero level of their
/// distance field, which also rounds edges by the length of a voxel. A sheet becomes a plate of the
/// thickness `voxel`. So does a closed part whose mean thickness is less, in addition to its own.
/// `source` is the nearest triangle of `mesh`, which also gives the attributes.
///
/// \param voxel  edge of the voxels, model units, above 0
/// \param open  what parts with open edges are
/// \throws InputError where nothing has an extent
/// \throws Interrupted where `progress` asks for it
TriangleMesh wrapped(const TriangleMesh& mesh, double voxel, OpenParts open = OpenParts::by_area,
                     const Progress& progress = {});

/// The changes that wrapped_solid() made.
struct WrapStats {
  OpenSheetStats sheets;
  RepairStats repair;  ///< of the other parts
};

/// A valid model around a plain mesh: take_sheets(), then repair() of the other parts, then
/// wrapped().
///
/// \param voxel  edge of the voxels, model units, above 0
/// \param options  of repair()
/// \param open  what parts with open edges are
/// \param stats  where given, receives the counts
/// \throws InputError where no triangle bounds anything, and where the new surface is no valid
///   model
/// \throws Interrupted where `progress` asks for it
TriangleMesh wrapped_solid(TriangleMesh mesh, double voxel, const RepairOptions& options = {},
                           OpenParts open = OpenParts::by_area, WrapStats* stats = nullptr,
                           const Progress& progress = {});

}  // namespace geo
