// What cannot go straight: carried along by a smooth field of what all want, and where that does not do, as rigid
// zones.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "contact/motion/rigid_zones.h"

namespace geo {

class FallbackMotion {
 public:
  /// The field of `rows` that want to go from start to `to`, no further than it is one-to-one all the way. `edge`: that
  /// of the surface, model units. Refers to all of them; nothing is carried yet.
  FallbackMotion(const std::vector<Triangle>& triangles, std::span<const std::uint32_t> rows,
                 const std::vector<Vec3>& start, const std::vector<Vec3>& to, double edge);

  /// Carries all corners of these pairs of triangles; as a rigid zone those of a pair that were carried before. True
  /// when that is new.
  bool add(std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs);
  /// Carries everything, by the field where it is in no zone. True when that is new.
  bool add_all();
  /// Puts what is carried where it comes to.
  void place(std::vector<Vec3>& next) const;

  /// Whether two triangles, which share no corner and are so far from each other where the motion begins, cannot pass
  /// each other since the field or a zone carries both: only flat triangles in a field that is not may cross.
  bool keep_apart(std::uint32_t s, std::uint32_t t, double distance) const;
  /// How far the field carries, of what all want.
  double share() const { return share_; }
  std::size_t in_zones() const { return zones_.size(); }

 private:
  const std::vector<Triangle>& triangles_;
  std::span<const std::uint32_t> rows_;
  const std::vector<Vec3>& start_;
  double share_ = 1;
  std::vector<Vec3> field_;        // where it carries each row
  std::vector<double> deviation_;  // per triangle, of its inside
  std::vector<std::uint8_t> carried_;
  RigidZones zones_;
};

}  // namespace geo
