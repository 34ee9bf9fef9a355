// Rigid motions nearest to the motion of sets of nodes.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// A rigid motion of a set of nodes: a translation, and a rotation about the centre of mass.
struct RigidMotion {
  Vec3 centre = Vec3::Zero();        ///< centre of mass before the motion
  Vec3 translation = Vec3::Zero();   ///< of the centre
  Mat3 rotation = Mat3::Identity();  ///< by any angle; the nearest to the nodes' motion in the quadratic mean
  Vec3 angle = Vec3::Zero();  ///< rotation vector at first order, rad: leaves no angular momentum about the centre
  double radius = 0;          ///< radius of gyration about the centre, m

  /// Displacement of a point by the translation and the finite rotation.
  Vec3 displacement(const Vec3& at) const { return translation + (rotation * (at - centre) - (at - centre)); }
  /// Displacement of a point at first order in the angle, along a straight line.
  Vec3 linearised(const Vec3& at) const { return translation + angle.cross(at - centre); }
  /// Correction that bends share · displacement, a straight line, to the arc of a rotation by
  /// share · angle. The part of the displacement that is not linearised() rotates, too.
  Vec3 arc_correction(const Vec3& at, const Vec3& displacement, double share) const;
};

/// The rigid motions that a set of nodes has.
enum class Freedom : std::uint8_t { none, translation, rigid };

/// The rigid motion of each set of nodes, weighted by mass. `set`: per node, below freedom.size();
/// node i moves by `displacement(i)` from `from(i)` on. Sets without freedom have no motion; sets
/// on a line have no rotation about it. The result is the same for any number of threads. Both
/// functions are called from several threads.
std::vector<RigidMotion> rigid_motions(const std::vector<std::uint32_t>& set, const std::vector<Freedom>& freedom,
                                       const std::vector<double>& mass, const std::function<Vec3(std::size_t)>& from,
                                       const std::function<Vec3(std::size_t)>& displacement);

}  // namespace geo
