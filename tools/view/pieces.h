// Pieces of a surface for pictures, found from its triangles alone, deformed or not.
#pragma once

#include <vector>

#include "view/subject.h"

namespace view {

/// A piece is an outer shell with the cavities and inner cracks in it.
struct PieceMap {
  std::vector<std::uint32_t> of_row;  ///< per vertex row
  std::vector<geo::Vec3> center;      ///< per piece: of its box
};

PieceMap pieces_of(const geo::TriangleMesh& mesh);

/// The piece of each node of a subject with a body: that of the surface which its graph component
/// carries.
std::vector<std::uint32_t> pieces_of_nodes(const Subject& subject, const PieceMap& pieces);

}  // namespace view
