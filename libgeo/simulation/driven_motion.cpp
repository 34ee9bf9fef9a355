// A key between equal ones changes no pose: interpolation between equal values is exact.
#include "simulation/driven_motion.h"

#include <numbers>
#include <utility>

#include "geometry/rotation.h"

namespace geo {

Motion::Key key_at(double time, const Pose& pose) {
  const Eigen::AngleAxisd turn = axis_and_angle(pose.rotation);
  return {.time = time,
          .position = pose.position,
          .axis = turn.angle() == 0 ? Vec3(Vec3::UnitZ()) : turn.axis(),
          .angle = turn.angle() * 180 / std::numbers::pi};
}

void drive(Motion& motion, double now, const Motion::Key& next, AfterLastKey after) {
  auto& keys = motion.keys;
  const bool reaches_now = !keys.empty() && keys.back().time <= now;
  Motion::Key present = reaches_now ? keys.back() : key_at(now, motion.at(now));
  const bool was_removed = reaches_now && keys.back().time < now && after == AfterLastKey::removed;
  present.time = now;
  if (was_removed) keys.clear();
  std::erase_if(keys, [&](const Motion::Key& key) { return key.time > now; });
  if (keys.empty() || keys.back().time < now) keys.push_back(present);
  keys.push_back(next);
}

}  // namespace geo
