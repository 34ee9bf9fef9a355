// The broad phase: pairs of triangles whose boxes meet, kept and updated during a step.
#pragma once

#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "contact/detection/triangle_planes.h"
#include "geometry/aabb_tree.h"

namespace geo {

/// A superset of the pairs of triangles without a common vertex whose boxes meet. A triangle that
/// stays within its previous box costs nothing. Boxes are relative to a point that moves with the
/// surface.
class BroadPhase {
 public:
  /// Indices of two triangles.
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  /// Pairs per triangle, on average, that a motion may add to those at rest. With more, it takes
  /// triangles far past each other, and its cost has no bound.
  static constexpr std::size_t max_per_triangle = 200;

  /// Updates pairs() for new boxes, box(t) for triangle t. With `changed`, only marked triangles
  /// have boxes that differ from the previous call. A triangle that has left its box gets a new
  /// one, extended by `margin` (model units). All pairs are searched anew at the first call,
  /// after invalidate(), and, without `changed`, when a quarter of the triangles have left their
  /// boxes. `triangles` must be the same until reset(): they decide which pairs share a vertex.
  /// Returns whether at most `most` pairs of these boxes meet. If not, nothing is known, as after
  /// invalidate().
  bool update(std::span<const Triangle> triangles, const std::function<Box3(std::size_t)>& box, double margin,
              const std::vector<std::uint8_t>* changed = nullptr, std::size_t most = ~std::size_t(0));

  /// Updates pairs() for the largest share of a motion, 1, 1/2, … 1/128 or 0, with at most
  /// most_of_motion() pairs, and returns it. box(t) is that of the whole motion at first;
  /// take(share) has to change it to that of a share.
  double update_for_share(std::span<const Triangle> triangles, const std::function<Box3(std::size_t)>& box,
                          double margin, const std::function<void(double)>& take);
  /// Pairs that the motion of the last update_for_share() may have: 200 per triangle, and those at
  /// rest if the whole motion has more than that.
  std::size_t most_of_motion() const { return most_of_motion_; }

  /// From now on pairs() has only those with a triangle that is marked (1); empty: all. Discards
  /// pairs as invalidate() does.
  void select(std::vector<std::uint8_t> marked) {
    invalidate();
    marked_ = std::move(marked);
  }

  /// Pairs i < j, each once, in no order that results may depend on.
  const std::vector<Pair>& pairs() const { return pairs_; }
  /// Scratch memory for the caller's culling of pairs(), which is reused from step to step.
  TrianglePlanes& planes() { return planes_; }
  /// Discards boxes and pairs at the start of another step of the same triangles. The order of the
  /// tree is kept.
  void invalidate() {
    valid_ = false;
    pairs_.clear();
  }
  /// Discards everything. Must be called before an update with other triangles.
  void reset() {
    select({});
    tree_ = {};
  }

 private:
  TrianglePlanes planes_;
  AabbTree tree_;
  std::vector<std::uint8_t> marked_;  // per triangle, or empty: select()
  bool valid_ = false;                // tree_ has the boxes of this step
  std::size_t most_of_motion_ = 0;
  std::vector<Pair> pairs_;
};

}  // namespace geo
