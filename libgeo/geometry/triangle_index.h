// A dynamic spatial index over triangles, by id: what may be near a box, at a cost that follows the answer.
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec.h"

namespace geo {

/// Hash grids (Teschner et al. 2003), one for each power of four of the triangles' sizes, so that a mesh may hold large
/// and small ones and become finer where it is cut. Blocks of cells let a query pass empty space quickly.
class TriangleIndex {
 public:
  /// Adds an id with its box. Ids are small integers and each is in the index at most once.
  void insert(std::uint32_t id, const Box3& box);
  /// Removes an id that is in the index.
  void erase(std::uint32_t id);
  /// Appends to `out`, ascending and each once, the ids whose boxes meet `box`.
  void find(const Box3& box, std::vector<std::uint32_t>& out) const;
  /// As find() for the box of a triangle, grown by `reach`, without those whose boxes are clear of its plane: cost follows
  /// the triangle's area, not its box's volume.
  void find_near_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double reach, std::vector<std::uint32_t>& out) const;
  /// Makes room for ids below `count` in all.
  void reserve(std::size_t count);
  bool contains(std::uint32_t id) const;

 private:
  static constexpr std::uint32_t none = ~0u;
  static constexpr int side = 4;  // cells along a block
  struct Range {
    std::int64_t lo[3], hi[3];
    Range shifted(int bits) const { return {{lo[0] >> bits, lo[1] >> bits, lo[2] >> bits}, {hi[0] >> bits, hi[1] >> bits, hi[2] >> bits}}; }
    double count() const { return double(hi[0] - lo[0] + 1) * double(hi[1] - lo[1] + 1) * double(hi[2] - lo[2] + 1); }
  };
  struct Slot {
    std::uint64_t key = ~0ull;  // no block has this one
    std::uint32_t block = none;
  };
  /// 4 × 4 × 4 cells: which of them hold anything, and the first entry of each.
  struct Block {
    std::uint64_t filled = 0;
    std::uint32_t first[side * side * side];
  };
  struct Entry {
    std::uint32_t id, next;
  };
  /// The triangles whose boxes are between an eighth and half of a cell long.
  struct Level {
    int exponent;
    double cell;
    std::size_t entries = 0;
    std::vector<Slot> slots;    // open addressing, a power of two
    std::vector<Block> blocks;  // never fewer: a region that was cut is cut again
    Range cells_of(const Box3& box) const;
    std::size_t slot_of(std::uint64_t key) const;
    std::uint32_t block_at(std::int64_t x, std::int64_t y, std::int64_t z) const;
    Block& make_block(std::int64_t x, std::int64_t y, std::int64_t z);
  };
  class Plane;
  Level& level_of(const Box3& box);
  template <class Take>
  void visit(const Level& level, const std::int64_t (&at)[3], const Range& cells, const Plane* plane, const Take& take) const;
  template <class Take>
  void visit_all(const Level& level, const Take& take) const;
  static void keep_each_once(std::vector<std::uint32_t>& out, std::size_t first);

  std::vector<Level> levels_;   // by exponent
  std::vector<Entry> entries_;  // lists, one a cell
  std::uint32_t free_ = none;   // list of entries to use again
  std::vector<Box3> boxes_;     // by id; empty box: not in the index
};

}  // namespace geo
