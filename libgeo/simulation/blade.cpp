#include "simulation/scene.h"

namespace geo {

std::vector<Vec3> Blade::at(double time) const {
  const Pose pose = motion.at(time);
  std::vector<Vec3> world;
  for (const Vec3& p : points) world.push_back(pose * p);
  return world;
}

}  // namespace geo
