// Poses of blades and obstacles of kerf/scene.h. World = motion · place: a keyframed motion is
// applied after the pose at rest.
#include "kerf/scene.h"

namespace geo {

std::vector<Vec3> Blade::at(double time) const {
  const Pose pose = motion.at(time);
  std::vector<Vec3> world;
  for (const Vec3& p : points) world.push_back(pose * p);
  return world;
}

Pose SceneObstacle::pose(double time) const {
  const Pose moved = motion.at(time);
  return {moved * place.position, moved.rotation * place.rotation};
}

}  // namespace geo
