// Turns a surface that is nearly solid into a solid, and refines meshes that are too coarse.
#pragma once

#include <cstddef>

#include "kerf/mesh.h"

namespace geo {

/// The changes that repair() made, in its order.
struct RepairStats {
  std::size_t welded_vertices = 0;    ///< vertices merged into others
  std::size_t dropped_triangles = 0;  ///< degenerate (a vertex twice) or duplicate
  std::size_t flipped_triangles = 0;  ///< orientation reversed
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

/// A plain mesh (no sites) with edges of at most `longest`, model units. Longer edges are bisected
/// repeatedly, for both triangles of each. The shape stays to rounding, vertices keep their
/// indices, triangles come in the order of those that contain them; attributes are interpolated. An
/// edge whose midpoint rounds to one of its ends stays. Throws InputError where more than 20
/// million triangles would result.
TriangleMesh refined(const TriangleMesh& mesh, double longest);

}  // namespace geo
