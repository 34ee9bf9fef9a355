// Fewer pieces: walls between small pieces and their neighbours left out.
#pragma once

#include "kerf/pieces.h"

namespace geo {

/// Drops walls until the model falls into `wanted` pieces: the smallest piece is joined with a
/// neighbour first, with the one it shares the largest area with. `cut` is the model with `walls`
/// as its crack number `crack`, `pieces` are its pieces. Only whole triangles are dropped, and only
/// where no part of a wall would stay inside of a piece; so there may be more pieces left than
/// wanted. Returns how many there are.
std::uint32_t join_small_pieces(TriangleMesh& walls, const Complex& cut, std::int32_t crack, const Pieces& pieces,
                                std::uint32_t wanted);

}  // namespace geo
