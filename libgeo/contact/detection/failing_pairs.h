// Pairs of triangles that a straight motion does not keep apart.
#pragma once

#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "contact/detection/surface_motion.h"
#include "contact/detection/triangle_planes.h"
#include "contact/detection/vertex_fans.h"

namespace geo {

/// A motion from where no triangles cross. Its end may change from call to call.
class FailingPairs {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  /// Of two triangles that share no corner, so far from each other where the motion begins: whether it is known that
  /// they do not pass each other.
  using KeptApart = std::function<bool(std::uint32_t s, std::uint32_t t, double distance)>;
  /// Refers to all of them. `together`: vertices_together(); fans are of the surface as it is. `rounding`: of products,
  /// model units. Fills `planes`.
  FailingPairs(const StandingRows& surface, const VertexFans& fans, std::span<const std::uint32_t> together,
               bool two_sided, const std::vector<Vec3>& start, const std::vector<Vec3>& next, double rounding,
               TrianglePlanes& planes);

  /// Of those pairs, which share no vertex of the surface, and of all that share one, that have a triangle marked in
  /// `changed` (whose end is another than at the call before; at the first all must be, with the end that there was
  /// when this was made): those that cross at the end, by the exact test of crossing.h, or may have passed through each
  /// other on the way. That they have not is clear where one direction parts them at both ends, and where they are kept
  /// apart. Ascending.
  std::vector<Pair> among(std::span<const Pair> pairs, const std::vector<std::uint8_t>& changed,
                          const KeptApart& kept_apart);

 private:
  void renew_planes(const std::vector<std::uint8_t>& changed);

  const StandingRows& surface_;
  const std::vector<Triangle>& triangles_;
  const VertexFans& fans_;
  std::span<const std::uint32_t> together_;
  bool two_sided_;
  const std::vector<Vec3>&start_, &next_;
  double rounding_;
  TrianglePlanes& planes_;
  std::vector<std::uint8_t> opens_out_;  // per vertex: VertexFans::open_out() at the end
  bool asked_before_ = false;
};

}  // namespace geo
