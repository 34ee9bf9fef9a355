// A dynamic spatial index over triangles, by id: what may be near a box, at a cost that follows the answer.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/vec.h"

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
  /// As find() for the box of a triangle, grown by `reach`, without those whose boxes are clear of its plane: cost
  /// follows the triangle's area, not its box's volume.
  void find_near_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double reach,
                          std::vector<std::uint32_t>& out) const;
  /// Makes room for ids below `count` in all.
  void reserve(std::size_t count);
  bool contains(std::uint32_t id) const;
  /// The box that was inserted.
  const Box3& box(std::uint32_t id) const { return boxes_[id]; }

 private:
  static constexpr std::uint32_t none = ~0u;
  static constexpr int side = 4;  // cells along a block
  struct Range {
    std::int64_t lo[3], hi[3];
    Range shifted(int bits) const {
      return {{lo[0] >> bits, lo[1] >> bits, lo[2] >> bits}, {hi[0] >> bits, hi[1] >> bits, hi[2] >> bits}};
    }
    double count() const { return double(hi[0] - lo[0] + 1) * double(hi[1] - lo[1] + 1) * double(hi[2] - lo[2] + 1); }
  };
  struct Slot {
    std::int64_t at[3] = {};
    std::uint32_t block = none;
  };
  /// 4 × 4 × 4 cells: which of them hold anything, in which there is a block of the next finer level that does, and the
  /// first bunch of each.
  struct Block {
    std::uint64_t filled = 0, below = 0;
    std::uint32_t first[side * side * side];
    bool empty() const { return !(filled | below); }
  };
  /// A box within a cell, in 256ths of its edge, rounded outwards: boxes that meet there do so here, too.
  struct Part {
    std::uint8_t lo[3], hi[3];
    bool meets(const Part& b) const {
      return (lo[0] <= b.hi[0]) & (b.lo[0] <= hi[0]) & (lo[1] <= b.hi[1]) & (b.lo[1] <= hi[1]) & (lo[2] <= b.hi[2]) &
             (b.lo[2] <= hi[2]);
    }
  };
  /// Some triangles of a cell, one cache line. Only the first of a cell's bunches has free places, at its end.
  struct alignas(64) Bunch {
    static constexpr int size = 6;
    std::uint32_t next;
    std::uint32_t id[size];
    Part part[size];
  };
  static_assert(sizeof(Bunch) == 64);
  /// The triangles whose boxes are between an eighth and half of a cell long.
  struct Level {
    int exponent;
    double cell;
    std::vector<Slot> slots;    // open addressing, a power of two
    std::vector<Block> blocks;  // never fewer: a region that was cut is cut again
    Range cells_of(const Box3& box) const;
    Part part_of(const Box3& box, const std::int64_t (&at)[3]) const;
    std::size_t slot_of(const std::int64_t (&at)[3]) const;
    std::uint32_t block_at(const std::int64_t (&at)[3]) const { return slots[slot_of(at)].block; }
    Block& make_block(const std::int64_t (&at)[3]);
  };
  class Plane;
  std::size_t level_of(const Box3& box) const;
  void make_levels(int exponent);
  void tell_above(std::size_t level, const std::int64_t (&block)[3]);
  void forget_above(std::size_t level, const std::int64_t (&block)[3]);
  template <class Take>
  void visit(std::size_t level, const std::int64_t (&block)[3], const Box3& box, const Plane* plane,
             const Take& take) const;
  template <class Take>
  void search(const Box3& box, const Plane* plane, const Take& take, std::vector<std::uint32_t>& out) const;

  std::vector<Level> levels_;   // finest first, each four times as coarse as the one before
  std::vector<Bunch> bunches_;  // lists, one a cell
  std::uint32_t free_ = none;   // list of bunches to use again
  std::vector<Box3> boxes_;     // by id; empty box: not in the index
};

}  // namespace geo
