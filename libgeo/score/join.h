// Reduces the number of pieces: drops walls between small pieces and their neighbours.
#pragma once

#include "kerf/pieces.h"

namespace geo {

/// Drops walls until the model has `wanted` pieces: joins the smallest piece first, with the
/// neighbour that shares the largest area with it. `cut` is the model with `walls` as its crack
/// `crack`; `pieces` are its pieces. Only whole triangles are dropped, and only where no part of a
/// wall would remain inside a piece: more pieces than wanted may remain. Returns their number.
std::uint32_t join_small_pieces(TriangleMesh& walls, const Complex& cut, std::int32_t crack, const Pieces& pieces,
                                std::uint32_t wanted);

}  // namespace geo
