// Angular velocity from angular momentum, for bodies that may be flat or a line.
#pragma once

#include "kerf/vec.h"

namespace geo {

/// The principal axes of an inertia tensor.
struct PrincipalInertia {
  Mat3 axes;     ///< columns, orthonormal
  Vec3 moments;  ///< ascending

  /// Decomposes a symmetric inertia tensor.
  explicit PrincipalInertia(const Mat3& inertia);
  /// The angular velocity with this angular momentum, in components along `axes`. Zero about axes
  /// with a moment of at most `least_moment`: points on a line cannot turn about it.
  Vec3 angular_velocity(const Vec3& momentum, double least_moment) const;
};

}  // namespace geo
