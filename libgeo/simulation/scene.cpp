// Poses of blades and obstacles of kerf/scene.h, and its lists. World = motion · place: a keyframed
// motion is applied after the pose at rest.
#include "kerf/scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

double Load::share(double time) const {
  if (time <= from || time > until) return 0;
  return ramp > 0 ? std::min(1.0, (time - from) / ramp) : 1.0;
}

double Stitch::rest_length(double time) const {
  if (!(closing > 0) || time >= from + closing) return length;
  const double begin = slack.value_or(length);
  return time <= from ? begin : begin + (time - from) / closing * (length - begin);
}

void Scene::add_change(SceneChange change) {
  const auto later = std::upper_bound(changes.begin(), changes.end(), change.time,
                                      [](double time, const SceneChange& c) { return time < c.time; });
  changes.insert(later, std::move(change));
}

bool Scene::has_checkpoint(int frame) const {
  return frame % checkpoint_every == 0 || std::binary_search(checkpoints.begin(), checkpoints.end(), frame);
}

std::string Scene::integrator() const {
  if (!implicit) return "leapfrog";
  return scheme == ImplicitScheme::bossak ? "bossak" : "implicit";
}

// 1e-9 keeps rounding from adding a step where dt divides the frame.
int Scene::steps_per_frame() const { return std::max(1, static_cast<int>(std::ceil(1 / frame_rate / dt - 1e-9))); }

}  // namespace geo
