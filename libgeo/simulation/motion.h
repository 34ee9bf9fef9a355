// Rigid motion by keyframes: blades, grips.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "base/vec.h"

namespace geo {

/// Where a rigid thing is: world = position + rotation · local.
struct Pose {
  Vec3 position = Vec3::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vec3 operator*(const Vec3& local) const { return position + rotation * local; }
};

struct Motion {
  struct Key {
    double time = 0;  ///< s
    Vec3 position = Vec3::Zero();
    Vec3 axis = Vec3::UnitZ();  ///< not zero
    double angle = 0;           ///< degrees about axis
  };
  std::vector<Key> keys;  ///< ascending in time; none: stays where it is

  bool active(double time) const { return !keys.empty() && time >= keys.front().time && time <= keys.back().time; }
  /// Position interpolated linearly, rotation by its angle where both keys have the same axis (whole turns included), else
  /// spherically; before the first key and after the last one it stands still.
  Pose at(double time) const;
};

}  // namespace geo
