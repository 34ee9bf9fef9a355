// Labels of the pieces of material on surface vertices, kept up to date at a cost that follows the
// cut.
#pragma once

#include "body/incremental_cache.h"

namespace geo {

/// Labels the pieces of all surface vertices from scratch.
void label_pieces(Body& body);

/// The label of the piece that a node is in; −1: none.
std::int32_t piece_of(const Body& body, NodeId i);
/// The label of the piece that a point is in; −1: none.
std::int32_t piece_at(const Body& body, const Vec3& p);

/// A piece that a step detached.
struct DetachedPiece {
  std::int32_t piece;    ///< its label
  std::int32_t from;     ///< the label of the piece that it was part of
  SurfaceVertexId at;    ///< a surface vertex of it
  SurfaceVertexId rest;  ///< a surface vertex of the part that keeps the label
};

/// Updates labels after a step and returns the detached pieces. A crack face separates material
/// exactly when its two sides are on different shells. Only surface near new crack faces is
/// visited, and the smaller of two parts. Sets `relabelled` and labels all pieces anew in two
/// cases: a piece that may have inner shells came apart, or a piece without a node was joined to
/// another.
std::vector<DetachedPiece> update_piece_labels(Body& body, const CrackDelta& delta, bool& relabelled);

}  // namespace geo
