// Motion::at() of kerf/scene.h. Between keys: linear in position; linear in the angle about a
// common axis, else spherical interpolation of quaternions (Shoemake 1985).
#include "kerf/scene.h"

#include <algorithm>
#include <numbers>

#include "geometry/rotation.h"

namespace geo {

Pose Motion::at(double time) const {
  if (keys.empty()) return {};
  const auto rotation = [](const Key& k, double degrees) {
    return rotation_about(k.axis.normalized(), degrees * std::numbers::pi / 180);
  };
  std::size_t i = 0;
  while (i + 2 < keys.size() && keys[i + 1].time <= time) ++i;
  if (keys.size() == 1) return {keys[0].position, rotation(keys[0], keys[0].angle)};
  const Key &a = keys[i], &b = keys[i + 1];
  const double t = std::clamp((time - a.time) / (b.time - a.time), 0.0, 1.0);
  // At a key, the pose is the key's to the bit, whatever the keys beside it are.
  if (t == 0) return {a.position, rotation(a, a.angle)};
  if (t == 1) return {b.position, rotation(b, b.angle)};
  const Vec3 position = a.position + t * (b.position - a.position);
  if (a.axis == b.axis) return {position, rotation(a, a.angle + t * (b.angle - a.angle))};
  return {position, rotation_between(rotation(a, a.angle), rotation(b, b.angle), t)};
}

}  // namespace geo
