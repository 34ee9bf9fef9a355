// Fallback for vertices whose straight motion would cross something: they follow a smooth field of
// the motion that all vertices want, and where that is not enough they move in rigid impact zones.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "contact/motion/rigid_zones.h"

namespace geo {

/// The set of vertices that follow the field, which grows until nothing crosses.
class FallbackMotion {
 public:
  /// The field of the motion of `vertices` from `start` to `to` (both per vertex). It is scaled
  /// down so that the motion is one-to-one at all times. `edge`: mean edge of the surface, model
  /// units. No vertex follows it yet. Refers to everything.
  FallbackMotion(const std::vector<Triangle>& triangles, std::span<const std::uint32_t> vertices,
                 const std::vector<Vec3>& start, const std::vector<Vec3>& to, double edge);

  /// Lets the vertices of these pairs of triangles follow the field; pairs that did so before are
  /// merged into rigid zones. Returns whether that changed anything.
  bool add(std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs);
  /// Lets all vertices follow the field, except those in zones. Returns whether that changed
  /// anything.
  bool add_all();
  /// Writes the end positions of the vertices that follow to `next`.
  void apply(std::vector<Vec3>& next) const;

  /// Whether field or zones keep triangles s and t from passing each other. They share no vertex
  /// and start at the given distance, model units. Triangles are flat and the field bends them, so
  /// near ones may cross in it.
  bool keeps_apart(std::uint32_t s, std::uint32_t t, double distance) const;
  /// The scale of the field, at most 1: share of the wanted motion.
  double share() const { return share_; }
  /// Number of vertices in rigid zones.
  std::size_t in_zones() const { return zones_.vertex_count(); }

 private:
  const std::vector<Triangle>& triangles_;
  std::span<const std::uint32_t> vertices_;
  const std::vector<Vec3>& start_;
  double share_ = 1;
  std::vector<Vec3> end_;          // per vertex, of the field
  std::vector<double> deviation_;  // per triangle: how far the field bends its inside off the plane, at most
  std::vector<std::uint8_t> follows_;
  RigidZones zones_;
};

}  // namespace geo
