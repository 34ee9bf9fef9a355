// A dynamic tree of cells over node positions: who is near a point, at a cost that follows the answer.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Rows of a position array by cell: an octree in one array, whose leaves are linked lists in another, so that any
/// grading of the nodes will do. 12 bytes a node or less. The array of positions stays with the caller and is passed to
/// each call.
class NodeGrid {
 public:
  /// `cell`: the usual spacing of nodes, model units; callers ask for it, and it is the size of the first cell.
  explicit NodeGrid(double cell = 1.0) : cell_(cell) {}
  NodeGrid(double cell, std::span<const Vec3> positions);

  /// Puts in a row that is not there, at its place in `positions`; those of all rows in the grid must be valid.
  void insert(std::span<const Vec3> positions, std::uint32_t row);
  /// Takes out a row that is there and was put in at p.
  void erase(std::uint32_t row, const Vec3& p);
  /// Appends the rows within `radius` of p (closed ball), in ascending order.
  void within(std::span<const Vec3> positions, const Vec3& p, double radius, std::vector<std::uint32_t>& out) const;
  /// The k rows nearest to p by (distance, row), without `self`; fewer when there are fewer. `accept` may refuse rows.
  template <class Accept>
  std::vector<std::uint32_t> nearest(std::span<const Vec3> positions, const Vec3& p, std::size_t k, std::uint32_t self,
                                     const Accept& accept) const;
  /// Walks down the tree: into(depth, middle, half) tells whether to enter a cube, middle ± half, which holds all rows
  /// that are below it; see(depth, row) gets the rows of each leaf entered. On the way to a cube those around it were
  /// entered, at depths 0, 1 and so on.
  template <class Into, class See>
  void walk(const Into& into, const See& see) const {
    if (!cells_.empty()) walk(root(), into, see);
  }
  std::size_t size() const { return size_; }
  double cell() const { return cell_; }
  /// What it takes in memory.
  std::size_t bytes() const { return cells_.capacity() * sizeof(Cell) + next_.capacity() * sizeof(std::uint32_t); }

 private:
  static constexpr std::uint32_t none = ~0u, inner = ~0u, most_in_leaf = 8;
  static constexpr int deepest = 40;
  struct Cell {
    std::uint32_t first = none;  // of the rows in a leaf, or of eight children
    std::uint32_t count = 0;     // of rows, or `inner`
  };
  struct Place {
    std::uint32_t cell = 0;
    Vec3 middle;
    double half = 0;
    int depth = 0;
    int octant(const Vec3& p) const {
      return (p.x() >= middle.x()) | (p.y() >= middle.y()) << 1 | (p.z() >= middle.z()) << 2;
    }
  };
  Place root() const { return {0, middle_, half_, 0}; }
  Place child(const Place& parent, int octant) const {
    const double h = 0.5 * parent.half;
    const Vec3 step(octant & 1 ? h : -h, octant & 2 ? h : -h, octant & 4 ? h : -h);
    return {cells_[parent.cell].first + static_cast<std::uint32_t>(octant), parent.middle + step, h, parent.depth + 1};
  }
  Place leaf_of(const Vec3& p) const;
  void put(std::span<const Vec3> positions, std::uint32_t row);
  void begin_anew(std::span<const Vec3> positions, const Box3& box);
  /// Calls see(row) for the rows in all cells that are no farther from p than the square root of `reach`, which may
  /// shrink on the way, the nearer cells first. `gap`: from p to the cell along each axis.
  template <class See>
  void visit(const Place& at, const Vec3& p, const Vec3& gap, const double& reach, const See& see) const;

  template <class Into, class See>
  void walk(const Place& at, const Into& into, const See& see) const;

  double cell_;
  std::size_t size_ = 0;
  Vec3 middle_ = Vec3::Zero();
  double half_ = 0;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> next_;  // by row: the next in its leaf
};

template <class See>
void NodeGrid::visit(const Place& at, const Vec3& p, const Vec3& gap, const double& reach, const See& see) const {
  const Cell& cell = cells_[at.cell];
  if (cell.count != inner) {
    for (auto row = cell.first; row != none; row = next_[row]) see(row);
    return;
  }
  // Cells behind a plane are as far as the plane at least. Gaps are rounded as distances to nodes are, and rounding is
  // monotone: no node is nearer than the gap to its cell, to the last bit.
  const int home = at.octant(p);
  const Vec3 across = (p - at.middle).cwiseAbs();
  for (const int turn : {0, 1, 2, 4, 3, 5, 6, 7}) {
    Vec3 to = gap;
    for (int axis = 0; axis < 3; ++axis)
      if (turn >> axis & 1) to[axis] = std::max(gap[axis], across[axis]);
    if (to.squaredNorm() <= reach) visit(child(at, home ^ turn), p, to, reach, see);
  }
}

template <class Into, class See>
void NodeGrid::walk(const Place& at, const Into& into, const See& see) const {
  // Middles were rounded once a level: 40 roundings of numbers no larger than the farthest corner.
  const double rounding = 0x1p-47 * (middle_.cwiseAbs().maxCoeff() + half_);
  const Cell& cell = cells_[at.cell];
  if (cell.count == 0 || !into(at.depth, at.middle, at.half + rounding)) return;
  if (cell.count == inner)
    for (int octant = 0; octant < 8; ++octant) walk(child(at, octant), into, see);
  else
    for (auto row = cell.first; row != none; row = next_[row]) see(at.depth, row);
}

template <class Accept>
std::vector<std::uint32_t> NodeGrid::nearest(std::span<const Vec3> positions, const Vec3& p, std::size_t k,
                                             std::uint32_t self, const Accept& accept) const {
  std::vector<std::uint32_t> rows;
  if (cells_.empty() || k == 0) return rows;
  std::vector<std::pair<double, std::uint32_t>> best;  // a heap, the farthest on top
  double reach = std::numeric_limits<double>::infinity();
  visit(root(), p, Vec3::Zero(), reach, [&](std::uint32_t row) {
    const std::pair found{(positions[row] - p).squaredNorm(), row};
    if (row == self || (best.size() == k && !(found < best.front())) || !accept(row)) return;
    if (best.size() == k) std::pop_heap(best.begin(), best.end()), best.pop_back();
    best.push_back(found);
    std::push_heap(best.begin(), best.end());
    if (best.size() == k) reach = best.front().first;
  });
  std::sort_heap(best.begin(), best.end());
  for (const auto& [square, row] : best) rows.push_back(row);
  return rows;
}

}  // namespace geo
