// Words that the sources of the crack complex share: how a face lies at an edge. Not part of the public interface.
#pragma once

#include <string>
#include <vector>

#include "kerf/complex.h"
#include "kerf/error.h"

namespace geo {

/// The corner of `f` at v, or −1.
inline int corner_at(const Complex::Face& f, VertexId v) {
  for (int k = 0; k < 3; ++k)
    if (f.v[k] == v) return k;
  return -1;
}

/// True when `f` runs from the lower to the higher of a, b along its boundary.
inline bool runs_upwards(const Complex::Face& f, VertexId a, VertexId b) {
  const VertexId lo = std::min(a, b), hi = std::max(a, b);
  return f.v[(corner_at(f, lo) + 1) % 3] == hi;
}

/// Seen with the higher id towards the eye, the side before the face (1) looks counter-clockwise when the face runs
/// upwards along the edge, and the side behind it (0) does when it runs downwards.
inline bool faces_counterclockwise(const Complex::Face& f, int which, VertexId a, VertexId b) {
  return runs_upwards(f, a, b) == (which == 1);
}
inline int side_facing(const Complex::Face& f, VertexId a, VertexId b, bool counterclockwise) {
  return runs_upwards(f, a, b) == counterclockwise ? 1 : 0;
}

inline bool has_side(const Complex::Face& f, int which) { return which == 0 || f.crack > 0; }

inline std::string edge_name(VertexId a, VertexId b) { return std::to_string(a.value) + "-" + std::to_string(b.value); }

/// Throws GeometryError unless every wedge of the ring is bounded by two material sides or by two air sides.
template <class Shape>
void check_ring(const std::vector<FaceId>& ring, VertexId lo, VertexId hi, const Shape& shape) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const auto f = shape(ring[i]), g = shape(ring[i + 1 == ring.size() ? 0 : i + 1]);
    const bool from = has_side(f, side_facing(f, lo, hi, true)), to = has_side(g, side_facing(g, lo, hi, false));
    if (from != to)
      throw GeometryError("at edge " + edge_name(lo, hi) + " a wedge has material on one side and air on the other");
  }
}

}  // namespace geo
