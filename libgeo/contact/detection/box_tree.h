// Which boxes of a set meet: a tree over them, sixteen boxes at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// Boxes in the order of a space-filling curve, sixteen to a block, and boxes around blocks. Blocks hold floats, in a
/// frame where these are fine: going there is monotone, so boxes that meet still do; which ones meet is decided by the
/// boxes themselves.
class BoxTree {
 public:
  static constexpr std::uint32_t width = 16;
  struct Block {
    alignas(64) float lo[3][width], hi[3][width];
  };
  /// Corners of the triangles whose boxes are in a block.
  struct Corners {
    alignas(64) std::uint32_t v[3][width];
  };
  /// Numbers of the cells of a grid that boxes' middles are in, along each axis.
  struct Cells {
    alignas(64) std::uint32_t at[3][width];
  };

  BoxTree() = default;
  /// Finite boxes; empty ones meet none. `triangles`: whose boxes they are, or empty.
  explicit BoxTree(std::vector<Box3> boxes, std::span<const Triangle> triangles = {});

  /// Other boxes of the same things, taken from `boxes`: the curve stays that of the first ones, which is as good while
  /// they have not gone far. False, and all is as it was, `boxes` too, where there are not as many as before, or where
  /// one that was empty at first no longer is.
  bool replace(std::vector<Box3>& boxes);

  /// Other boxes of the same triangles: by replace(), but where what follows each other on the curve has gone a fifth
  /// further apart since it was found, or all of it too far for floats, and in a tree that has none yet, the curve is
  /// found anew.
  void put(std::vector<Box3> boxes, std::span<const Triangle> triangles);

  const std::vector<Box3>& boxes() const { return boxes_; }
  /// Makes a box larger, so that it holds this one, too.
  void enlarge(std::uint32_t row, const Box3& box);
  /// All pairs (i < j) of boxes that meet, each once, neighbours near each other, in an order that depends on the boxes
  /// and `only` alone; after replace() or enlarge() it is still told by the curve of the first boxes, and may not be
  /// that of a new tree. Only pairs with a box marked in `only`, where given; none of two triangles with a corner in
  /// common. By all threads; cost follows the boxes that are asked for, and the pairs. `narrow`, where given, is called
  /// for some of them at a time, by any thread, and takes those out that are not wanted.
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  Pairs pairs(const std::vector<std::uint8_t>* only = nullptr, const std::function<void(Pairs&)>& narrow = {}) const;

  /// levels()[0] holds the boxes, levels()[l] those around blocks of levels()[l − 1].
  const std::vector<std::vector<Block>>& levels() const { return levels_; }

 private:
  double block_sizes() const;  // of the boxes around blocks, three edges each
  void fill();

  std::vector<Box3> boxes_;
  Vec3 middle_ = Vec3::Zero();                // of the first boxes; floats are relative to it
  double made_ = 0;                           // block_sizes() when the curve was found
  std::vector<std::uint32_t> order_, place_;  // rows in the order of the tree, and where each is
  std::vector<std::vector<Block>> levels_;
  std::vector<Corners> corners_;  // a block each of the lowest level; empty: of none
};

}  // namespace geo
