// A static bounding volume hierarchy over triangles: blocked segments, inside or outside, closest point.
#pragma once

#include <span>
#include <vector>

#include "geometry/wide_bvh.h"
#include "kerf/vec.h"

namespace geo {

/// Median-split tree of closed boxes. Built once in O(n log n); queries are exact (predicates.h) and thread-safe.
class TriangleBvh {
 public:
  TriangleBvh() = default;
  /// Copies the triangles' corners; an empty soup is allowed.
  explicit TriangleBvh(std::span<const std::array<Vec3, 3>> triangles);

  std::size_t size() const { return corners_.size(); }
  bool empty() const { return corners_.empty(); }
  const Box3& box() const { return box_; }

  /// True when the closed segment pq touches any triangle: exact.
  bool blocks(const Vec3& p, const Vec3& q) const;
  /// The same for many segments from p, all at once: 1 in `result` where the one to `ends[i]` is blocked. Fast where
  /// the ends are near p and each other.
  void blocks(const Vec3& p, std::span<const Vec3> ends, std::uint8_t* result) const {
    lanes_.blocked(corners_, order_, p, ends, result);
  }
  /// Appends the rows of all triangles whose boxes meet `box`, in no particular order.
  void near(const Box3& box, std::vector<std::uint32_t>& rows) const;

  struct Closest {
    std::uint32_t triangle = ~0u;  ///< ~0u: none within the cutoff
    Vec3 point = Vec3::Zero();
    double distance = 0;
  };
  /// The closest triangle within `cutoff` of p.
  Closest closest(const Vec3& p, double cutoff = std::numeric_limits<double>::infinity()) const;

  /// True when p is strictly inside the closed oriented surface that the triangles form: exact crossing parity of a
  /// ray; rays that touch an edge or vertex are replaced by others. A point on the surface is not inside.
  bool inside(const Vec3& p) const;

 private:
  struct Node {
    Box3 box;
    std::uint32_t first = 0, count = 0;  // count 0: children are first and first + 1
  };
  struct Builder;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
  std::vector<std::array<Vec3, 3>> corners_;
  WideBvh lanes_;  // over the same order
  Box3 box_;
};

}  // namespace geo
