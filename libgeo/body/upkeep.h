// What a split keeps for the next one, so that its cost follows the cut: pieces by surface vertex, depths, strays.
#pragma once

#include "kerf/body.h"

namespace geo {

/// Derives body.upkeep where it is not there (a body just built or read). Costs once over the surface.
void begin_upkeep(Body& body);

/// The pieces of all surface vertices, counted from scratch.
void count_pieces(Body& body);

/// The piece of material that a node or a point is in; −1: none.
std::int32_t piece_of(const Body& body, NodeId i);
std::int32_t piece_at(const Body& body, const Vec3& p);

/// A piece that a step cut off.
struct Offcut {
  std::int32_t piece, from;  ///< its number, and the number of what it was cut from
  SurfaceVertexId at, rest;  ///< a surface vertex of it, and one of the part that keeps the number
};

/// Brings the pieces of surface vertices up to date after a step: only what new crack faces can have separated is
/// looked at, and of two parts the one with less surface. A crack face parts material exactly when its sides are on
/// different shells. `recounted` is set when that was not enough: a piece that may have inner shells came apart, or a
/// crumb was joined to something, and all pieces were counted (and numbered) anew.
std::vector<Offcut> part_pieces(Body& body, const CrackDelta& delta, bool& recounted);

}  // namespace geo
