// Rotations as Eigen has them, with the same bits in every C library (base/elementary.h).
#pragma once

#include <Eigen/Geometry>

#include "kerf/vec.h"

namespace geo {

/// The rotation about an axis of length 1 by an angle, radians.
Eigen::Quaterniond rotation_about(const Vec3& axis, double angle);
/// The axis, of length 1, and the angle of a rotation, radians from 0 to π; the x axis where there
/// is no rotation.
Eigen::AngleAxisd axis_and_angle(const Eigen::Quaterniond& rotation);
/// The rotation at a share of the shortest way from a to b (Shoemake 1985).
Eigen::Quaterniond rotation_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b, double share);

}  // namespace geo
