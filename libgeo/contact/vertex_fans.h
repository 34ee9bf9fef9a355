// Triangles around each vertex, as a quick look at neighbours that cannot cross.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"

namespace geo {

/// Of the triangles of a surface, each vertex for itself.
class VertexFans {
 public:
  /// `together`: per vertex the row that says where it is (vertices_together()).
  VertexFans(const std::vector<Triangle>& triangles, std::span<const std::uint32_t> together);

  /// Whether some direction looks at the front of all triangles around v, which close around it once: then no two of them have
  /// more in common than corners and edges. Floating point, but never true where that is not so.
  bool open_out(std::uint32_t v, const std::vector<Vec3>& at) const;
  const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
  struct Link {
    std::uint32_t from, to;
  };
  const std::vector<Triangle>& triangles_;
  std::span<const std::uint32_t> together_;
  std::vector<std::uint32_t> first_;
  std::vector<Link> link_;             // per vertex and triangle: the edge across, in rows
  std::vector<std::uint8_t> closed_;   // each end of an edge across is another's beginning, and no beginning is twice there
};

}  // namespace geo
