// Counts the pairs of triangles of a surface that cross: of a deformed frame or of a plain mesh.
//
// Two triangles cross if they have a common point other than shared vertices and edges. On a
// two-sided surface, copies of one site (a vertex of the crack complex) with equal coordinates, to
// the bit, count as one vertex. The two sides of a face with coincident corners touch, as in every
// new crack; they do not cross. Exact.
#pragma once

#include <cstddef>
#include <memory>

#include "kerf/mesh.h"

namespace geo {

/// Counts the crossings of one surface after the other, such as the frames of a run. Faster than
/// count_crossings() if consecutive surfaces have the same triangles: fans and the tree of boxes
/// are then reused.
class CrossingCounter {
 public:
  /// A counter that has seen no surface.
  CrossingCounter();
  ~CrossingCounter();
  /// Takes the cache of the other counter, which must not be used afterwards.
  CrossingCounter(CrossingCounter&&) noexcept;
  /// As the move constructor.
  CrossingCounter& operator=(CrossingCounter&&) noexcept;

  /// The number of pairs of triangles that cross. No triangle may have a vertex twice.
  std::size_t count(const TriangleMesh& surface);

 private:
  struct Cache;
  std::unique_ptr<Cache> cache_;
};

/// The number of pairs of triangles of one surface that cross, as CrossingCounter::count().
std::size_t count_crossings(const TriangleMesh& surface);

}  // namespace geo
