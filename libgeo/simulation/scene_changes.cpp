// Bounds of values are those that scene files have. The ratio of a body's stiffness to the scene's
// is kept, since one slider stands for all.
#include "simulation/scene_changes.h"

#include <cmath>

namespace geo {
namespace {

// Copies what a change may set.
void copy_values(const Scene& from, Scene& to) {
  to.material = from.material;
  to.gravity = from.gravity;
  to.friction = from.friction;
  to.contact.friction = from.contact.friction;
  to.accuracy = from.accuracy;
  to.dt = from.dt;
  to.bodies.resize(from.bodies.size());
  to.obstacles.resize(from.obstacles.size());
  for (std::size_t b = 0; b < from.bodies.size(); ++b) to.bodies[b].material = from.bodies[b].material;
  for (std::size_t o = 0; o < from.obstacles.size(); ++o) to.obstacles[o].friction = from.obstacles[o].friction;
}

}  // namespace

std::string unfit(const SceneChange& change) {
  const auto outside = [](const std::optional<double>& value, double least, double most) {
    return value && !(*value >= least && *value <= most);
  };
  if (!std::isfinite(change.time)) return "the time of a change is not finite";
  if (outside(change.young, 1e-6, 1e15)) return "'young' must be from 1e-06 to 1e+15";
  if (outside(change.damping, 0, 1e6)) return "'damping' must be from 0 to 1e+06";
  if (outside(change.friction, 0, 1)) return "'friction' must be from 0 to 1";
  if (outside(change.accuracy, 1e-9, 0.1)) return "'accuracy' must be from 1e-09 to 0.1";
  if (outside(change.dt, 1e-9, 1e6)) return "'step' must be from 1e-09 to 1e+06";
  if (change.gravity && !(change.gravity->norm() <= 1e9)) return "'gravity' must be finite, and at most 1e+09";
  return {};
}

SceneChanges::SceneChanges(const Scene& scene) { copy_values(scene, original_); }

void SceneChanges::revert(Scene& scene) {
  copy_values(original_, scene);
  applied_ = 0;
}

bool SceneChanges::apply(Scene& scene, double time) {
  const std::size_t before = applied_;
  for (; applied_ < scene.changes.size() && scene.changes[applied_].time <= time; ++applied_)
    apply(scene, scene.changes[applied_]);
  return applied_ != before;
}

void SceneChanges::apply(Scene& scene, const SceneChange& change) {
  if (change.young) {
    const double ratio = *change.young / scene.material.young;
    scene.material.young = *change.young;
    for (SceneBody& body : scene.bodies)
      if (body.material) body.material->young *= ratio;
  }
  if (change.damping) {
    scene.material.damping = *change.damping;
    for (SceneBody& body : scene.bodies)
      if (body.material) body.material->damping = *change.damping;
  }
  if (change.gravity) scene.gravity = *change.gravity;
  if (change.friction) {
    scene.friction = scene.contact.friction = *change.friction;
    for (SceneObstacle& obstacle : scene.obstacles) obstacle.friction = *change.friction;
  }
  if (change.accuracy) scene.accuracy = *change.accuracy;
  if (change.dt) scene.dt = *change.dt;
}

}  // namespace geo
