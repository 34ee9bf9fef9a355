// Making a solid of a surface that is nearly one.
#pragma once

#include <cstddef>

#include "kerf/mesh.h"

namespace geo {

/// What repair() did, in its order.
struct Repairs {
  std::size_t welded = 0;   ///< vertices that became others
  std::size_t dropped = 0;  ///< triangles with a vertex twice, or there twice
  std::size_t turned = 0;   ///< triangles
  std::size_t holes = 0;    ///< closed, with so many
  std::size_t added = 0;    ///< triangles
  std::size_t smooth = 0;   ///< of the holes, those closed by smooth patches
  std::size_t hidden = 0;   ///< shells left out: solid ones wholly inside another solid one
  bool nothing() const { return welded + dropped + turned + holes + hidden == 0; }
};

/// Turns a plain mesh (no sites) into a solid as far as its topology is what is wrong: welds seams (weld_seams), open
/// ones also where they are up to `reach` apart (model units); drops triangles that bound nothing; makes neighbours run
/// the same way; closes holes, each by triangles between its corners, or, where `smooth` asks for it and nothing
/// crosses, by a patch that goes on from the surface around it (fair_patch); turns shells outwards, and inwards those
/// that are cavities of another. Attributes stay with their triangles; a hole's have those of its rim. Vertices that no
/// triangle has go. Triangles that cross, and edges of more than two, stay: check_surface() tells.
Repairs repair(TriangleMesh& mesh, double reach = 0, bool smooth = false);

// ---- Shorter edges where a mesh is coarser than what it is to touch, or than it is to bend.

/// A plain mesh (no sites) with edges of `longest` at most, model units: longer ones are divided in the middle, again
/// and again, the same for both triangles of each. The shape stays to rounding, vertices keep their rows, triangles
/// come in the order of those that they are parts of; attributes are interpolated. An edge whose middle is one of its
/// ends by rounding stays. Throws InputError where more than 20 million triangles would come of it.
TriangleMesh refined(const TriangleMesh& mesh, double longest);

}  // namespace geo
