// A dynamic spatial index over triangles, by id: what may be near a box, at a cost that follows the answer.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "base/vec.h"

namespace geo {

/// A hash grid (Teschner et al. 2003) of closed boxes. Each id is found by every query box that meets its box.
class TriangleIndex {
 public:
  /// `cell` is the edge length of a cell, best near the mean edge length of the triangles; > 0.
  explicit TriangleIndex(double cell = 1.0) : cell_(cell) {}

  /// Adds an id with its box. Ids are small integers and each is in the index at most once.
  void insert(std::uint32_t id, const Box3& box);
  /// Removes an id that is in the index.
  void erase(std::uint32_t id);
  /// Appends to `out`, ascending and each once, the ids whose boxes meet `box`.
  void find(const Box3& box, std::vector<std::uint32_t>& out) const;
  bool contains(std::uint32_t id) const;
  double cell() const { return cell_; }

 private:
  struct Range {
    std::int64_t lo[3], hi[3];
  };
  Range cells_of(const Box3& box) const;

  double cell_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
  std::vector<Box3> boxes_;           // by id; empty box: not in the index
  std::vector<std::uint32_t> large_;  // ids whose boxes cover too many cells to be listed in each
};

}  // namespace geo
