// Rigid motions nearest to how the nodes of pieces move.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// About the middle of a piece's mass: this goes `way`, and the piece turns about it.
struct RigidMotion {
  Vec3 middle = Vec3::Zero(), way = Vec3::Zero();
  Mat3 turn = Mat3::Identity();  ///< by any angle: the nearest in the quadratic mean
  Vec3 turning = Vec3::Zero();   ///< as velocities turn, rad: what is left has no angular momentum about the middle
  double reach = 0;              ///< how far from the middle the piece's mass is, in the quadratic mean, m

  /// Of what is at this place: by the way and the turn,
  Vec3 displacement(const Vec3& at) const { return way + (turn * (at - middle) - (at - middle)); }
  /// by the way and straight on as turning begins,
  Vec3 straight(const Vec3& at) const { return way + turning.cross(at - middle); }
  /// and what going round by `share` of turning adds to a way straight on, that much of a displacement: what it has
  /// besides straight() is turned, too.
  Vec3 bend(const Vec3& at, const Vec3& displacement, double share) const;
};

/// What is known of a piece's motion.
enum class Freedom : std::uint8_t { none, way, way_and_turn };

/// Per piece; of one without freedom, no motion. `piece`: of each node, of as many as `freedom` has. Node i goes
/// `way(i)` from `from(i)`. Sums are weighed by mass, in an order that no number of threads changes. What is on one
/// line has no turning about it, and no turn.
std::vector<RigidMotion> rigid_motions(const std::vector<std::uint32_t>& piece, const std::vector<Freedom>& freedom,
                                       const std::vector<double>& mass, const std::function<Vec3(std::size_t)>& from,
                                       const std::function<Vec3(std::size_t)>& way);

}  // namespace geo
