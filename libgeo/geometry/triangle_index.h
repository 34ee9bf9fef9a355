// A dynamic spatial index of triangles: queries by box and by triangle, at a cost that follows the
// answer.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// A hierarchy of hash grids (Teschner et al. 2003), one for each power of four of the triangles'
/// sizes, so that large and small triangles coexist and a mesh may be refined where it is cut.
/// Cells are grouped in blocks, by which a query skips empty space.
class TriangleIndex {
 public:
  /// Inserts an id with its box. Ids are small integers; the id must not be in the index.
  void insert(std::uint32_t id, const Box3& box);
  /// Removes an id, which must be in the index.
  void erase(std::uint32_t id);
  /// Appends to `out`, ascending and each once, the ids whose boxes meet `box`.
  void find(const Box3& box, std::vector<std::uint32_t>& out) const;
  /// As find() for the box of triangle abc, extended by `reach`, without ids whose boxes are
  /// farther than `reach` from its plane: the cost follows the triangle's area, not the volume of
  /// its box.
  void find_near_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double reach,
                          std::vector<std::uint32_t>& out) const;
  /// Reserves memory for ids below `count`.
  void reserve(std::size_t count);
  /// Whether the id is in the index.
  bool contains(std::uint32_t id) const;
  /// The box that the id was inserted with.
  const Box3& box(std::uint32_t id) const { return boxes_[id]; }

 private:
  static constexpr std::uint32_t none = ~0u;
  static constexpr int side = 4;  // cells along a block
  struct Range {                  // of grid coordinates, both ends included
    std::int64_t lo[3], hi[3];
    /// The same range in coordinates of cells 2^bits times as long.
    Range shifted(int bits) const {
      return {{lo[0] >> bits, lo[1] >> bits, lo[2] >> bits}, {hi[0] >> bits, hi[1] >> bits, hi[2] >> bits}};
    }
    /// Number of cells.
    double count() const { return double(hi[0] - lo[0] + 1) * double(hi[1] - lo[1] + 1) * double(hi[2] - lo[2] + 1); }
  };
  struct Slot {  // of the hash table of blocks
    std::int64_t at[3] = {};
    std::uint32_t block = none;
  };
  // 4 × 4 × 4 cells. `filled`: cells with entries; `below`: cells that coincide with a non-empty
  // block of the next finer level; `first`: for each cell, the first chunk of its list.
  struct Block {
    std::uint64_t filled = 0, below = 0;
    std::uint32_t first[side * side * side];
    /// Whether no cell has entries, here or below.
    bool empty() const { return !(filled | below); }
  };
  // The part of a box in a cell, in 256ths of the cell's edge. Rounded monotonically: boxes that
  // meet in the cell meet here, too.
  struct QuantizedBox {
    std::uint8_t lo[3], hi[3];
    /// Whether the boxes have a common point.
    bool meets(const QuantizedBox& b) const {
      return (lo[0] <= b.hi[0]) & (b.lo[0] <= hi[0]) & (lo[1] <= b.hi[1]) & (b.lo[1] <= hi[1]) & (lo[2] <= b.hi[2]) &
             (b.lo[2] <= hi[2]);
    }
  };
  // Some entries of a cell, in one cache line. The chunks of a cell form a linked list, of which
  // only the first may have unused places, at its end.
  struct alignas(64) Chunk {
    static constexpr int size = 6;
    std::uint32_t next;
    std::uint32_t id[size];
    QuantizedBox box[size];
  };
  static_assert(sizeof(Chunk) == 64);
  // The grid of boxes whose longest sides are between an eighth and half of a cell.
  struct Level {
    int exponent;
    double cell;                // edge length, 2^exponent
    std::vector<Slot> slots;    // open addressing; size: a power of two
    std::vector<Block> blocks;  // never removed: a region that was cut is likely to be cut again
    /// The cells that a box meets.
    Range cells_of(const Box3& box) const;
    /// The part of a box in the cell at `at`.
    QuantizedBox quantize(const Box3& box, const std::int64_t (&at)[3]) const;
    /// The slot of the block at `at`, or the empty slot where it belongs.
    std::size_t slot_of(const std::int64_t (&at)[3]) const;
    /// The index of the block at `at`, or none.
    std::uint32_t block_at(const std::int64_t (&at)[3]) const { return slots[slot_of(at)].block; }
    /// The block at `at`, which is added if it does not exist.
    Block& find_or_add_block(const std::int64_t (&at)[3]);
  };
  class Plane;
  std::size_t level_of(const Box3& box) const;
  void add_levels(int exponent);
  void link_to_parents(std::size_t level, const std::int64_t (&block)[3]);
  void unlink_from_parents(std::size_t level, const std::int64_t (&block)[3]);
  template <class Visit>
  void visit_block(std::size_t level, const std::int64_t (&block)[3], const Box3& box, const Plane* plane,
                   const Visit& visit) const;
  template <class Visit>
  void search(const Box3& box, const Plane* plane, const Visit& visit, std::vector<std::uint32_t>& out) const;

  std::vector<Level> levels_;  // finest first; the cells of each are four times as long as of the one before
  std::vector<Chunk> chunks_;
  std::uint32_t free_ = none;  // list of unused chunks
  std::vector<Box3> boxes_;    // by id; empty: not in the index
};

}  // namespace geo
