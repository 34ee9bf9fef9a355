#include "simulation/obstacles.h"

#include <algorithm>

#include "simulation/between_bodies.h"

namespace geo {
namespace {

Eigen::Isometry3d isometry(const Pose& p) {
  Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
  at.linear() = p.rotation.toRotationMatrix(), at.translation() = p.position;
  return at;
}

}  // namespace

Obstacles::Obstacles(const Scene& scene) {
  for (const SceneObstacle& o : scene.obstacles) {
    TriangleMesh mesh = o.mesh;
    for (Vec3& p : mesh.vertices) p *= o.scale;
    shapes_.push_back(std::make_shared<RigidShape>(mesh.triangles.empty() ? RigidShape::half_space(o.normal) : RigidShape(mesh)));
  }
  if (scene.ground && scene.self_contact) shapes_.push_back(std::make_shared<RigidShape>(RigidShape::half_space(scene.ground_normal)));
}

void Obstacles::begin(const Scene& scene, const Body& body, const Solid& solid, const SurfaceWeights* weights, const std::vector<std::uint32_t>& part,
                      const State& motion, double time, double dt, Environment& environment) {
  const bool mutual = scene.bodies.size() > 1 && scene.body_contact && !scene.self_contact;
  if (shapes_.empty() && !mutual) return;
  if (!weights) {
    if (!own_) own_.emplace().update(body, solid);
    weights = &*own_;
  }
  // As stiff as the same penalty on each node of the lowest layer: acceleration times mass over area; by the nodes there are now,
  // so that a run taken up does the same.
  double layer = 0, spacing = 0, fastest = 0;
  for (std::size_t i = 0; i < solid.size(); ++i) layer += solid.mass(NodeId(i)) / (body.nodes.spacing[i] * body.nodes.spacing[i]), spacing += body.nodes.spacing[i];
  layer /= double(solid.size()), spacing /= double(solid.size());
  for (const Vec3& v : motion.velocity) fastest = std::max(fastest, v.norm());
  const double fall = dt * environment.gravity.norm();
  acting_.clear();
  for (std::size_t k = 0; k < shapes_.size(); ++k) {
    const bool ground = k == scene.obstacles.size();
    ObstacleOptions options{ground ? scene.ground_stiffness : scene.obstacles[k].stiffness, ground ? scene.friction : scene.obstacles[k].friction};
    options.pressure *= layer;
    Eigen::Isometry3d from = Eigen::Isometry3d::Identity(), to = from;
    if (ground) from.translation() = to.translation() = scene.ground_point;
    else from = isometry(scene.obstacles[k].pose(time)), to = isometry(scene.obstacles[k].pose(time + dt));
    const double moved = (to.translation() - from.translation()).norm() + shapes_[k]->extent() * Eigen::AngleAxisd(from.linear().transpose() * to.linear()).angle();
    acting_.emplace_back(shapes_[k], options, from, to);
    acting_.back().watch(body, *weights, motion.displacement, 2 * dt * (fastest + fall) + moved + spacing, 1e-2 * std::max(dt * fall, moved) + 1e-6 * spacing);
  }
  if (scene.ground && scene.self_contact) environment.ground = false;
  for (Obstacle& o : acting_) environment.contact.push_back(&o);
  if (!mutual) return;
  mutual_ = between_bodies(body, solid, *weights, part, motion.displacement,
                           {scene.contact_stiffness * layer, scene.contact.friction, 4 * dt * (fastest + fall) + spacing, 1e-2 * dt * fall + 1e-6 * spacing});
  if (!mutual_->empty()) environment.contact.push_back(&*mutual_);
}

void Obstacles::reaction(const State& motion, double share, FrameWork& work) const {
  work.obstacle_force.resize(shapes_.size(), Vec3::Zero()), work.obstacle_torque.resize(shapes_.size(), Vec3::Zero());
  for (std::size_t k = 0; k < acting_.size(); ++k) {
    const Obstacle::Reaction r = acting_[k].reaction(motion.displacement);
    work.obstacle_force[k] += share * r.force, work.obstacle_torque[k] += share * r.torque;
  }
}

}  // namespace geo
