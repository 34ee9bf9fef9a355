// The pieces of material that the cracks have made: which side of which face belongs to which piece.
#pragma once

#include <cstdint>
#include <vector>

#include "surface/complex.h"

namespace geo {

/// A piece is a connected region of material. Its boundary may have several shells: an internal cavity, or a crack that
/// never reaches the skin, belongs to the piece around it.
struct Pieces {
  std::uint32_t count = 0;
  std::uint32_t shells = 0;           ///< closed surfaces that bound them, inner ones included: at least `count`
  std::vector<std::int32_t> of_side;  ///< piece of side (face, which) at [2·face + which], −1 where there is none
  std::vector<double> volume;         ///< per piece, model units³; they sum to the skin's volume
};

/// Pieces in descending order of volume (ties: by lowest face id).
Pieces find_pieces(const Complex& complex);

/// The closed boundary of one piece as a mesh of its own (patch, site and source filled). `of`: which surface vertex each row is.
TriangleMesh piece_mesh(const Complex& complex, const Pieces& pieces, std::uint32_t piece, std::vector<SurfaceVertexId>* of = nullptr);

}  // namespace geo
