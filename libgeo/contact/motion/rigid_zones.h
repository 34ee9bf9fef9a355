// Rigid impact zones: groups of vertices that move as one rigid body, since nothing else is known
// to keep their triangles from crossing (Provot 1997; Bridson, Fedkiw, Anderson 2002).
#pragma once

#include <cstdint>
#include <vector>

#include "base/union_find.h"
#include "kerf/vec.h"

namespace geo {

/// Disjoint zones of vertices.
class RigidZones {
 public:
  /// No zones yet, of `vertices` vertices.
  explicit RigidZones(std::size_t vertices) : sets_(vertices), in_zone_(vertices, 0) {}

  /// Puts the vertices of both triangles into one zone, and merges it with the zones that they were
  /// in. Returns whether that changed anything.
  bool merge(const Triangle& s, const Triangle& t);
  /// Whether one zone contains all vertices of both triangles.
  bool contain(const Triangle& s, const Triangle& t) const;
  /// Number of vertices in zones.
  std::size_t vertex_count() const;
  /// The vertices of each zone, ascending; zones in the order of their first vertices.
  std::vector<std::vector<std::uint32_t>> zones() const;

 private:
  UnionFind sets_;
  std::vector<std::uint8_t> in_zone_;
};

}  // namespace geo
