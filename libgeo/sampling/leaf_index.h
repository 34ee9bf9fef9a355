// Leaves of an octree by position, for neighbour queries.
#pragma once

#include <cstdint>
#include <vector>

#include "sampling/lattice.h"

namespace geo {

/// Leaves in Morton order, found by binary search within blocks of cells. Thread-safe.
class LeafIndex {
 public:
  /// `codes`: Morton codes of leaves that do not overlap, ascending; `levels`: their levels.
  LeafIndex(std::vector<std::uint64_t> codes, std::vector<std::uint8_t> levels);

  /// Number of leaves.
  std::size_t size() const { return codes_.size(); }
  /// The cell of a leaf.
  Cell cell(std::size_t leaf) const { return {corner_of(codes_[leaf]), levels_[leaf]}; }
  /// Let C be the cell of level `level` that contains c. Calls visit(leaf), once each, for the
  /// leaves that meet C or one of the 26 cells of that size around C. c is of that level or finer.
  template <class Visit>
  void around(const Cell& c, int level, const Visit& visit) const;

 private:
  std::vector<std::uint64_t> codes_;
  std::vector<std::uint8_t> levels_;
  int block_ = 0;                           // level of a block
  std::array<std::int32_t, 3> blocks_{};    // along each axis
  std::vector<std::uint32_t> begin_, end_;  // range of leaves in each block
};

/// See above.
template <class Visit>
void LeafIndex::around(const Cell& c, int level, const Visit& visit) const {
  const std::int32_t edge = 1 << level, unit = 1 << std::min(level, block_);
  std::array<std::int32_t, 3> lo, hi;
  for (int i = 0; i < 3; ++i) {
    const std::int32_t at = c.corner[i] & ~(edge - 1);
    lo[i] = std::max(0, at - edge);
    hi[i] = std::min(at + 2 * edge, blocks_[i] << block_);
  }
  std::array<std::int32_t, 3> p;
  for (p[2] = lo[2]; p[2] < hi[2]; p[2] += unit)
    for (p[1] = lo[1]; p[1] < hi[1]; p[1] += unit)
      for (p[0] = lo[0]; p[0] < hi[0]; p[0] += unit) {
        const auto block = (static_cast<std::size_t>(p[2] >> block_) * static_cast<std::size_t>(blocks_[1]) +
                            static_cast<std::size_t>(p[1] >> block_)) *
                               static_cast<std::size_t>(blocks_[0]) +
                           static_cast<std::size_t>(p[0] >> block_);
        const std::uint32_t begin = begin_[block], end = end_[block];
        if (begin == end) continue;
        const std::uint64_t first = morton(p), past = first + (std::uint64_t(1) << 3 * std::min(level, block_));
        auto leaf = static_cast<std::uint32_t>(std::lower_bound(codes_.begin() + begin, codes_.begin() + end, first) -
                                               codes_.begin());
        if (leaf > begin && (leaf == end || codes_[leaf] != first)) {
          // A larger leaf may hold this cell: it is taken at the first of the cells that it holds.
          const int large = levels_[leaf - 1];
          if (codes_[leaf - 1] >> 3 * large == first >> 3 * large) {
            const auto corner = corner_of(codes_[leaf - 1]);
            if (p[0] == std::max(corner[0], lo[0]) && p[1] == std::max(corner[1], lo[1]) &&
                p[2] == std::max(corner[2], lo[2]))
              visit(leaf - 1);
          }
        }
        for (; leaf < end && codes_[leaf] < past; ++leaf) visit(leaf);
      }
}

}  // namespace geo
