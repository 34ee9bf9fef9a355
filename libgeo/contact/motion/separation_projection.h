// Triangles that would pass through each other give way: where they are to go is mended, before
// anything goes there.
#pragma once

#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "contact/detection/simplex.h"
#include "contact/motion/rigid_zones.h"
#include "kerf/mesh.h"

namespace geo {

/// Couples of triangles, or of what they do not share (disjoint_subsimplices()), each with a
/// direction that parts them where a straight motion begins.
class SeparationProjection {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  /// `gap`: that couples keep, model units, or what the direction parts them by at the beginning.
  SeparationProjection(const std::vector<Triangle>& triangles, const std::vector<Vec3>& start, double gap)
      : triangles_(triangles), start_(start), gap_(gap), zones_(start.size()) {}

  /// Pairs that the motion from start to `next` does not keep apart: of some directions that part
  /// one about as well as any does at the beginning, the one that parts it most at the end; anew
  /// where a pair was added before. Pairs so near each other that rounding hides all directions are
  /// bound.
  void add(std::span<const Pair> pairs, const std::vector<Vec3>& next);
  /// From now on these pairs, and all that were bound to one of them, move as one rigid zone. True
  /// when that is new.
  bool bind(std::span<const Pair> pairs);
  /// Whether two triangles are in one zone: what does not change its shape cannot pass itself.
  bool bound(std::uint32_t s, std::uint32_t t) const { return zones_.contain(triangles_[s], triangles_[t]); }
  std::size_t in_zones() const { return zones_.vertex_count(); }

  /// Moves the end of the motion until all couples are parted by their directions, or for many
  /// sweeps: each in turn the least it takes, half by half (position based dynamics, Müller et al.
  /// 2007), in the order in which they were added; zones after each sweep.
  void push(std::vector<Vec3>& next) const;

 private:
  struct Kept {
    Simplex a, b;  // corners that are not there are the first again
    Vec3 normal;   // from b to a
    double apart;
    std::uint32_t s, t;  // the pair
  };
  const std::vector<Triangle>& triangles_;
  const std::vector<Vec3>& start_;
  double gap_;
  std::vector<Kept> couples_;
  std::unordered_map<std::uint64_t, std::size_t> known_;  // the first couple of each pair
  RigidZones zones_;
};

}  // namespace geo
