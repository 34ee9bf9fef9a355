// How a face of the crack complex K lies at an edge (Weiler's radial edge): which way it runs,
// which sides it turns there.
#pragma once

#include <algorithm>
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

/// True when `f` runs from the lower to the higher of a, b along its boundary. Precondition: f has
/// edge ab.
inline bool runs_upwards(const Complex::Face& f, VertexId a, VertexId b) {
  const VertexId lo = std::min(a, b), hi = std::max(a, b);
  return f.v[(corner_at(f, lo) + 1) % 3] == hi;
}

/// Whether side `which` of `f` looks counter-clockwise around edge ab, seen with the higher vertex
/// towards the eye: side 1 does when the face runs upwards along the edge, side 0 when it runs
/// downwards.
inline bool faces_counterclockwise(const Complex::Face& f, int which, VertexId a, VertexId b) {
  return runs_upwards(f, a, b) == (which == 1);
}
/// The side of `f` that looks counter-clockwise around edge ab, or clockwise.
inline int side_facing(const Complex::Face& f, VertexId a, VertexId b, bool counterclockwise) {
  return runs_upwards(f, a, b) == counterclockwise ? 1 : 0;
}

/// Whether material lies on side `which` of `f`.
inline bool has_side(const Complex::Face& f, int which) { return which == 0 || f.crack > 0; }
/// How many sides `f` has: one on skin, two on a crack.
inline int side_count(const Complex::Face& f) { return f.crack > 0 ? 2 : 1; }

/// "a-b", for messages.
inline std::string edge_name(VertexId a, VertexId b) { return std::to_string(a.value) + "-" + std::to_string(b.value); }

/// Checks a radial cycle around edge lo–hi; face_of(id) is the face of an id. Throws GeometryError
/// unless every wedge is bounded by two material sides or by two air sides.
template <class FaceOf>
void check_wedges(const std::vector<FaceId>& cycle, VertexId lo, VertexId hi, const FaceOf& face_of) {
  for (std::size_t i = 0; i < cycle.size(); ++i) {
    const auto f = face_of(cycle[i]), g = face_of(cycle[i + 1 == cycle.size() ? 0 : i + 1]);
    const bool from = has_side(f, side_facing(f, lo, hi, true)), to = has_side(g, side_facing(g, lo, hi, false));
    if (from != to)
      throw GeometryError("at edge " + edge_name(lo, hi) + " a wedge has material on one side and air on the other");
  }
}

}  // namespace geo
