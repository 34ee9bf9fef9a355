// Pairs of triangles that a step may bring together, kept while it is worked out what the step is.
#pragma once

#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "contact/detection/box_tree.h"
#include "contact/detection/triangle_planes.h"

namespace geo {

/// Every pair of triangles that share no corner and whose boxes meet is among those that cover() leaves, and some more:
/// a triangle that stays within the box that it had before costs nothing. Boxes are relative to a point that goes along
/// with the surface.
class NearPairs {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;

  /// `box`: of triangle t; only those marked in `changed` have another than at the call before, where given. `spare`:
  /// model units, by which what has left its box is given a larger one. All pairs are looked for at the first call, at
  /// the first after forget(), and after many have left. Triangles are the same, corner by corner, until
  /// forget_triangles(): their pairs with common corners are told by them.
  void cover(std::span<const Triangle> triangles, const std::function<Box3(std::size_t)>& box, double spare,
             const std::vector<std::uint8_t>* changed = nullptr);

  /// i < j, each once, in no order that anything should depend on.
  const std::vector<Pair>& pairs() const { return pairs_; }
  /// Room for what is asked about them, the caller's to fill: much memory, which is used again step by step.
  TrianglePlanes& planes() { return planes_; }
  /// Another step of the same triangles begins: nothing is known of its pairs. Where most triangles have stayed near
  /// each other, the tree's order will do again.
  void forget() { known_ = false, pairs_.clear(); }
  /// There are other triangles.
  void forget_triangles() { forget(), tree_ = {}; }

 private:
  TrianglePlanes planes_;
  BoxTree tree_;
  bool known_ = false;  // tree_ has this step's boxes
  std::vector<Pair> pairs_;
};

}  // namespace geo
