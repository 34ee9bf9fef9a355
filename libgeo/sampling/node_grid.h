// A dynamic hash grid over node positions: who is near a point, at a cost that follows the answer.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "base/vec.h"

namespace geo {

/// Rows of a position array by cell. The array stays with the caller and is passed to each query.
class NodeGrid {
 public:
  /// `cell` in model units, best near the node spacing.
  explicit NodeGrid(double cell = 1.0) : cell_(cell) {}
  NodeGrid(double cell, std::span<const Vec3> positions);

  void insert(std::uint32_t row, const Vec3& p);
  void erase(std::uint32_t row, const Vec3& p);
  /// Appends the rows within `radius` of p (closed ball), in ascending order.
  void within(std::span<const Vec3> positions, const Vec3& p, double radius, std::vector<std::uint32_t>& out) const;
  /// The k rows nearest to p by (distance, row), without `self`; fewer when there are fewer. `accept` may refuse rows.
  template <class Accept>
  std::vector<std::uint32_t> nearest(std::span<const Vec3> positions, const Vec3& p, std::size_t k, std::uint32_t self, const Accept& accept) const;
  std::size_t size() const { return size_; }
  double cell() const { return cell_; }

 private:
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    constexpr std::uint64_t mask = (1u << 21) - 1;
    return (std::uint64_t(x) & mask) << 42 | (std::uint64_t(y) & mask) << 21 | (std::uint64_t(z) & mask);
  }
  std::int64_t coordinate(double x) const;

  double cell_;
  std::size_t size_ = 0;
  Box3 box_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

template <class Accept>
std::vector<std::uint32_t> NodeGrid::nearest(std::span<const Vec3> positions, const Vec3& p, std::size_t k, std::uint32_t self,
                                             const Accept& accept) const {
  std::vector<std::uint32_t> rows;
  std::vector<std::pair<double, std::uint32_t>> found;
  const double everything = box_.diagonal() + (box_.empty() ? 0.0 : (p - box_.center()).norm()) + cell_;
  for (double radius = 1.75 * cell_;; radius *= 1.5) {
    rows.clear();
    found.clear();
    within(positions, p, radius, rows);
    for (const auto r : rows)
      if (r != self && accept(r)) found.push_back({(positions[r] - p).squaredNorm(), r});
    if (found.size() >= k || radius > everything) break;
  }
  const std::size_t n = std::min(k, found.size());
  std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(n), found.end());
  rows.clear();
  for (std::size_t i = 0; i < n; ++i) rows.push_back(found[i].second);
  return rows;
}

}  // namespace geo
