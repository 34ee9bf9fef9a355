// The cells of an octree: their positions, neighbours and order along the Morton curve.
#pragma once

#include <cstdint>

#include "kerf/vec.h"

namespace geo {

/// A cell of edge length size·2^level, with its lower corner at origin + size·corner.
struct Cell {
  std::array<std::int32_t, 3> corner;  ///< in finest cells, a multiple of 2^level, below 2^21
  std::int32_t level = 0;
};

/// Bits of three coordinates interleaved, x lowest: all cells within a cell follow each other.
inline std::uint64_t morton(const std::array<std::int32_t, 3>& c) {
  const auto spread = [](std::uint64_t x) {
    x &= 0x1fffff;
    x = (x | x << 32) & 0x1f00000000ffffull;
    x = (x | x << 16) & 0x1f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
  };
  return spread(static_cast<std::uint64_t>(c[0])) | spread(static_cast<std::uint64_t>(c[1])) << 1 |
         spread(static_cast<std::uint64_t>(c[2])) << 2;
}

/// The corner with this Morton code.
inline std::array<std::int32_t, 3> corner_of(std::uint64_t code) {
  const auto gather = [](std::uint64_t x) {
    x &= 0x1249249249249249ull;
    x = (x | x >> 2) & 0x10c30c30c30c30c3ull;
    x = (x | x >> 4) & 0x100f00f00f00f00full;
    x = (x | x >> 8) & 0x1f0000ff0000ffull;
    x = (x | x >> 16) & 0x1f00000000ffffull;
    return static_cast<std::int32_t>((x | x >> 32) & 0x1fffff);
  };
  return {gather(code), gather(code >> 1), gather(code >> 2)};
}

/// Positions of cells. Neighbouring cells have their common corners at the same point, bit for bit.
struct Lattice {
  Vec3 origin;
  double size;  ///< edge of a cell of level 0, model units

  /// Edge length of a cell.
  double edge(int level) const { return size * double(1 << level); }
  /// A corner of the finest cells.
  Vec3 point(std::int32_t x, std::int32_t y, std::int32_t z) const { return origin + size * Vec3(x, y, z); }
  /// The box of a cell.
  Box3 box(const Cell& c) const {
    const std::int32_t n = 1 << c.level;
    return {point(c.corner[0], c.corner[1], c.corner[2]), point(c.corner[0] + n, c.corner[1] + n, c.corner[2] + n)};
  }
  /// The middle of a cell.
  Vec3 middle(const Cell& c) const {
    return point(c.corner[0], c.corner[1], c.corner[2]) + Vec3::Constant(0.5 * edge(c.level));
  }
};

}  // namespace geo
