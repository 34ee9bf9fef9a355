// Nodes in Morton order under a tree of tight boxes, for nearest nodes and the spanning tree.
#pragma once

#include <cstdint>
#include <span>

#include "base/uninitialized_array.h"
#include "kerf/vec.h"

namespace geo {

/// The square of a vector's length, rounded as squared_distance() is.
inline double square_of(double x, double y, double z) { return (x * x + y * y) + z * z; }

/// A binary tree over nodes, split at bits of their Morton codes. Where the codes within one box
/// cannot separate nodes, the nodes are coded again within their own box. So leaves are small for
/// any distribution. Building takes O(n) and a radix sort. About 45 bytes a node.
class NodeTree {
 public:
  /// A leaf has at most this many nodes, or any number of nodes at one place.
  static constexpr std::uint32_t leaf_size = 10;

  /// A box of nodes.
  struct Cell {
    double lo[3], hi[3];         ///< tight, closed
    std::uint32_t begin, end;    ///< slots of its nodes
    std::uint32_t parent;        ///< of the root: itself
    std::uint32_t children = 0;  ///< the first of two in a row; 0: a leaf
    /// Has it no children?
    bool leaf() const { return children == 0; }
    /// Number of its nodes.
    std::uint32_t count() const { return end - begin; }
    /// The square of the gap to another box (to a point: pass it twice). gap() and diagonal(), the
    /// square of the box's diagonal, are rounded as squared distances of points are, and rounding
    /// is monotone. So a computed squared distance between nodes of two cells is never below their
    /// gap, and one within a cell never above its diagonal.
    double gap(const double* from, const double* to) const {
      return square_of(apart(0, from, to), apart(1, from, to), apart(2, from, to));
    }
    /// See gap().
    double diagonal() const { return square_of(hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]); }

   private:
    double apart(int axis, const double* from, const double* to) const {
      return std::max(std::max(lo[axis] - to[axis], from[axis] - hi[axis]), 0.0);
    }
  };

  /// Sorts the nodes and builds the tree; `positions` need not outlive it.
  explicit NodeTree(std::span<const Vec3> positions);

  /// Number of nodes.
  std::size_t size() const { return node_.size(); }
  /// Parents come before their children; [0] is the root, of no nodes when there are none.
  std::span<const Cell> cells() const { return cells_; }
  /// The node in each slot, ascending in a leaf whose nodes are at one place.
  std::span<const std::uint32_t> nodes() const { return node_; }
  /// One coordinate of the node in each slot; 16 more doubles may be read behind the last.
  const double* along(int axis) const { return coordinate_[axis].data(); }

 private:
  UninitializedArray<Cell> cells_;
  UninitializedArray<std::uint32_t> node_;
  UninitializedArray<double> coordinate_[3];
};

}  // namespace geo
