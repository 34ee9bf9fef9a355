// A tree of axis-aligned bounding boxes (AABBs): all pairs of boxes that meet.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// A 16-wide tree over boxes in the order of a Hilbert curve. Its groups hold floats relative to
/// the middle of all boxes. Rounding to floats is monotone, so boxes that meet still do; the
/// boxes themselves then decide which pairs meet.
class AabbTree {
 public:
  /// Boxes in a group.
  static constexpr std::uint32_t width = 16;
  /// The boxes of a group; unused ones are empty.
  struct BoxGroup {
    alignas(64) float lo[3][width], hi[3][width];
  };
  /// The vertices of the triangles whose boxes are in a group.
  struct Corners {
    alignas(64) std::uint32_t v[3][width];
  };
  /// The cells of a grid that contain the centres of boxes.
  struct Cells {
    alignas(64) std::uint32_t at[3][width];
  };
  /// Pairs of indices of boxes.
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

  /// A tree over no boxes.
  AabbTree() = default;
  /// A tree over finite boxes; empty ones meet none. `triangles`: the triangles that the boxes
  /// bound, or empty.
  explicit AabbTree(std::vector<Box3> boxes, std::span<const Triangle> triangles = {});

  /// Takes new boxes of the same objects and keeps the order of the curve, which remains good
  /// while the objects have not moved far. Returns false if their number differs, or if a box that
  /// was empty at the construction no longer is. Then it changes nothing, neither here nor in
  /// `boxes`.
  bool refit(std::vector<Box3>& boxes);

  /// Takes new boxes of the same triangles by refit(), or builds the tree anew. The latter if
  /// refit() fails, or if the sum of the groups' extents is > 1.2 or < 0.2 times that at the
  /// construction. It is small where boxes are too far from the origin of the floats.
  void refit_or_rebuild(std::vector<Box3> boxes, std::span<const Triangle> triangles);

  /// The current boxes.
  const std::vector<Box3>& boxes() const { return boxes_; }
  /// Extends box `index` to contain `box`.
  void enlarge(std::uint32_t index, const Box3& box);
  /// All pairs (i < j) of boxes that meet, each once, except pairs of triangles with a common
  /// vertex. With `marked`, only pairs with at least one marked box; the cost then follows these.
  /// `filter`, if given, is called for batches of pairs, from any thread, and removes unwanted
  /// ones. The order of pairs does not depend on the number of threads. After refit() or
  /// enlarge() it may differ from that of a new tree.
  Pairs pairs(const std::vector<std::uint8_t>* marked = nullptr, const std::function<void(Pairs&)>& filter = {}) const;
  /// As pairs(), if there are at most `most`; nothing if there are more, of which only some are
  /// then ever in memory.
  std::optional<Pairs> pairs_up_to(std::size_t most, const std::vector<std::uint8_t>* marked = nullptr,
                                   const std::function<void(Pairs&)>& filter = {}) const;

  /// levels()[0] holds the boxes, levels()[l] those around groups of levels()[l − 1].
  const std::vector<std::vector<BoxGroup>>& levels() const { return levels_; }

 private:
  double sum_of_extents() const;  // of the boxes around groups: lengths along the three axes
  void fill();

  std::vector<Box3> boxes_;
  Vec3 middle_ = Vec3::Zero();                // of the boxes at the construction: origin of the floats
  double built_extents_ = 0;                  // sum_of_extents() at the construction
  std::vector<std::uint32_t> order_, place_;  // index of the box at each place of the tree; the inverse
  std::vector<std::vector<BoxGroup>> levels_;
  std::vector<Corners> corners_;  // by group of the lowest level; empty: no triangles are known
};

/// All pairs (i < j) of boxes that meet, each once. `boxes` and `marked`: as in AabbTree.
inline AabbTree::Pairs overlapping_pairs(std::vector<Box3> boxes, const std::vector<std::uint8_t>* marked = nullptr) {
  return AabbTree(std::move(boxes)).pairs(marked);
}

}  // namespace geo
