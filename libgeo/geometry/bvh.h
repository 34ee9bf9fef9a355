// A static bounding volume hierarchy (BVH) over triangles: blocked segments, closest points, and
// whether a point is inside a closed surface.
#pragma once

#include <span>
#include <vector>

#include "geometry/wide_bvh.h"
#include "kerf/vec.h"

namespace geo {

/// A binary tree of closed boxes, split at medians. Built once in O(n log n). Queries are exact
/// (predicates.h) and thread-safe.
class TriangleBvh {
 public:
  /// A tree over no triangles.
  TriangleBvh() = default;
  /// Builds the tree and copies the corners. The triangles may be any soup, also an empty one.
  explicit TriangleBvh(std::span<const std::array<Vec3, 3>> triangles);

  /// Number of triangles.
  std::size_t size() const { return corners_.size(); }
  /// Whether there are no triangles.
  bool empty() const { return corners_.empty(); }
  /// The corners of a triangle.
  const std::array<Vec3, 3>& corners(std::uint32_t triangle) const { return corners_[triangle]; }
  /// The bounding box of all triangles.
  const Box3& box() const { return box_; }

  /// Whether the closed segment pq touches any triangle. Exact.
  bool blocks(const Vec3& p, const Vec3& q) const;
  /// blocks() for the segments from p to each of `ends`: writes 1 or 0 to result[i]. Fast if the
  /// ends are near p and near each other.
  void blocks(const Vec3& p, std::span<const Vec3> ends, std::uint8_t* result) const {
    wide_.blocked(corners_, order_, p, ends, result);
  }
  /// Appends the indices of all triangles whose boxes meet `box`, in no particular order.
  void near(const Box3& box, std::vector<std::uint32_t>& triangles) const;

  /// The result of closest().
  struct Closest {
    std::uint32_t triangle = ~0u;  ///< ~0u: none within the cutoff
    Vec3 point = Vec3::Zero();     ///< closest point of the triangle
    double distance = 0;           ///< of that point, model units
  };
  /// The closest triangle within distance `cutoff` of p; of several, the one with the lowest index.
  /// Returns the first triangle found within distance `enough`, if there is one.
  Closest closest(const Vec3& p, double cutoff = std::numeric_limits<double>::infinity(), double enough = -1) const;

  /// Whether p is strictly inside the closed oriented surface that the triangles form: the parity
  /// of a ray's crossings, counted exactly. A ray that touches an edge or vertex is replaced by
  /// another. A point on the surface is not inside.
  bool inside(const Vec3& p) const;

 private:
  struct Node {
    Box3 box;
    std::uint32_t first = 0, count = 0;  // count 0: the children are nodes first and first + 1
  };
  struct Builder;
  // Crossings of the segment pq with the surface, or why there is no such number.
  struct RayCrossings {
    bool on_surface = false;  // p lies on a triangle
    bool degenerate = false;  // the segment touches an edge, a vertex or a plane
    int count = 0;
  };
  RayCrossings count_crossings(const Vec3& p, const Vec3& q, double margin) const;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;  // indices of triangles, in the order of leaves
  std::vector<std::array<Vec3, 3>> corners_;
  WideBvh wide_;  // over the same order
  Box3 box_;
};

}  // namespace geo
