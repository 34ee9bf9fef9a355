// A dynamic octree over node positions for range and nearest-node queries.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Indices of positions by cell: an octree in one array, whose leaves are linked lists in another.
/// So it adapts to any grading of the nodes. At most 12 bytes a node. The array of positions stays
/// with the caller and is passed to each call.
class NodeGrid {
 public:
  /// An empty grid. `cell` (model units) is the usual spacing of nodes and half the least extent of
  /// the root.
  explicit NodeGrid(double cell = 1.0) : cell_(cell) {}
  /// A grid over all positions.
  NodeGrid(double cell, std::span<const Vec3> positions);

  /// Inserts an index, which is not in the grid, at its position. The positions of all indices in
  /// the grid must be valid.
  void insert(std::span<const Vec3> positions, std::uint32_t index);
  /// Erases an index, which was inserted at p.
  void erase(std::uint32_t index, const Vec3& p);
  /// Appends the indices within `radius` of p (closed ball), ascending.
  void within(std::span<const Vec3> positions, const Vec3& p, double radius, std::vector<std::uint32_t>& out) const;
  /// The k accepted indices nearest to p by (distance, index), without `self`; fewer when there are
  /// fewer. accept(index) may refuse some.
  template <class Accept>
  std::vector<std::uint32_t> nearest(std::span<const Vec3> positions, const Vec3& p, std::size_t k, std::uint32_t self,
                                     const Accept& accept) const;
  /// Walks down the tree. enter(depth, middle, half) decides whether to enter the cube middle ±
  /// half, which contains all indices below it; visit(depth, index) receives the indices of each
  /// leaf entered. The cubes above were entered before, at depths 0, 1 and so on.
  template <class Enter, class Visit>
  void walk(const Enter& enter, const Visit& visit) const {
    if (!cells_.empty()) walk(root(), enter, visit);
  }
  /// Number of indices in the grid.
  std::size_t size() const { return size_; }
  /// The usual spacing of nodes, as given.
  double cell() const { return cell_; }
  /// Bytes of memory.
  std::size_t bytes() const { return cells_.capacity() * sizeof(Cell) + next_.capacity() * sizeof(std::uint32_t); }

 private:
  // leaf_capacity: more nodes a leaf take less memory and more distance tests. max_depth bounds the
  // tree where positions coincide; a leaf there exceeds its capacity.
  static constexpr std::uint32_t none = ~0u, inner = ~0u, leaf_capacity = 8;
  static constexpr int max_depth = 40;
  struct Cell {
    std::uint32_t first = none;  // of the indices in a leaf, or of eight children
    std::uint32_t count = 0;     // of indices, or `inner`
  };
  struct CellBounds {
    std::uint32_t cell = 0;
    Vec3 middle;
    double half = 0;
    int depth = 0;
    /// The child that contains p: a bit for each axis.
    int octant(const Vec3& p) const {
      return (p.x() >= middle.x()) | (p.y() >= middle.y()) << 1 | (p.z() >= middle.z()) << 2;
    }
  };
  CellBounds root() const { return {.cell = 0, .middle = middle_, .half = half_, .depth = 0}; }
  CellBounds child(const CellBounds& parent, int octant) const {
    const double h = 0.5 * parent.half;
    const Vec3 step(octant & 1 ? h : -h, octant & 2 ? h : -h, octant & 4 ? h : -h);
    return {.cell = cells_[parent.cell].first + static_cast<std::uint32_t>(octant),
            .middle = parent.middle + step,
            .half = h,
            .depth = parent.depth + 1};
  }
  CellBounds leaf_of(const Vec3& p) const;
  void put(std::span<const Vec3> positions, std::uint32_t index);
  void rebuild(std::span<const Vec3> positions, const Box3& box);
  /// Calls visit(index) for the indices in all cells no farther from p than the square root of
  /// `reach`, which may shrink meanwhile; nearer cells first. `gap`: from p to the cell along each
  /// axis.
  template <class Visit>
  void visit_near(const CellBounds& at, const Vec3& p, const Vec3& gap, const double& reach, const Visit& visit) const;

  /// walk() below one cell.
  template <class Enter, class Visit>
  void walk(const CellBounds& at, const Enter& enter, const Visit& visit) const;

  double cell_;
  std::size_t size_ = 0;
  Vec3 middle_ = Vec3::Zero();
  double half_ = 0;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> next_;  // by index: the next in its leaf
};

/// See the declaration.
template <class Visit>
void NodeGrid::visit_near(const CellBounds& at, const Vec3& p, const Vec3& gap, const double& reach,
                          const Visit& visit) const {
  const Cell& cell = cells_[at.cell];
  if (cell.count != inner) {
    for (auto index = cell.first; index != none; index = next_[index]) visit(index);
    return;
  }
  // Cells behind a plane are as far as the plane at least. Gaps are rounded as distances to nodes
  // are, and rounding is monotone: no node is nearer than the gap to its cell, to the last bit.
  const int home = at.octant(p);
  const Vec3 across = (p - at.middle).cwiseAbs();
  for (const int turn : {0, 1, 2, 4, 3, 5, 6, 7}) {
    Vec3 to = gap;
    for (int axis = 0; axis < 3; ++axis)
      if (turn >> axis & 1) to[axis] = std::max(gap[axis], across[axis]);
    if (to.squaredNorm() <= reach) visit_near(child(at, home ^ turn), p, to, reach, visit);
  }
}

/// See the declaration.
template <class Enter, class Visit>
void NodeGrid::walk(const CellBounds& at, const Enter& enter, const Visit& visit) const {
  // Middles were rounded once a level: 40 roundings of numbers no larger than the farthest corner.
  const double rounding = 0x1p-47 * (middle_.cwiseAbs().maxCoeff() + half_);
  const Cell& cell = cells_[at.cell];
  if (cell.count == 0 || !enter(at.depth, at.middle, at.half + rounding)) return;
  if (cell.count == inner)
    for (int octant = 0; octant < 8; ++octant) walk(child(at, octant), enter, visit);
  else
    for (auto index = cell.first; index != none; index = next_[index]) visit(at.depth, index);
}

/// See the declaration.
template <class Accept>
std::vector<std::uint32_t> NodeGrid::nearest(std::span<const Vec3> positions, const Vec3& p, std::size_t k,
                                             std::uint32_t self, const Accept& accept) const {
  std::vector<std::uint32_t> indices;
  if (cells_.empty() || k == 0) return indices;
  std::vector<std::pair<double, std::uint32_t>> best;  // a heap, the farthest on top
  double reach = std::numeric_limits<double>::infinity();
  visit_near(root(), p, Vec3::Zero(), reach, [&](std::uint32_t index) {
    const std::pair found{(positions[index] - p).squaredNorm(), index};
    if (index == self || (best.size() == k && !(found < best.front())) || !accept(index)) return;
    if (best.size() == k) {
      std::pop_heap(best.begin(), best.end());
      best.pop_back();
    }
    best.push_back(found);
    std::push_heap(best.begin(), best.end());
    if (best.size() == k) reach = best.front().first;
  });
  std::sort_heap(best.begin(), best.end());
  for (const auto& [square, index] : best) indices.push_back(index);
  return indices;
}

}  // namespace geo
