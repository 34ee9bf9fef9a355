#include "simulation/obstacles.h"

#include <algorithm>

#include "contact/response/body_contact.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

Eigen::Isometry3d isometry(const Pose& p) {
  Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
  at.linear() = p.rotation.toRotationMatrix(), at.translation() = p.position;
  return at;
}

// The surface is within a support radius of its nodes. So what is far from obstacles needs no weights of its surface.
std::vector<std::uint8_t> near_nodes(const RigidShape& shape, const Eigen::Isometry3d& back, const NodeSet& nodes,
                                     const std::vector<Vec3>& u, double reach) {
  std::vector<std::uint8_t> near(nodes.size());
  parallel_for(nodes.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      near[i] = shape.near(back * (nodes.position[i] + u[i]), reach + nodes.radius[i]);
  });
  return near;
}

// True when the boxes that bodies may be in during the step meet.
bool parts_meet(const NodeSet& nodes, const std::vector<std::uint32_t>& part, const State& motion, double dt,
                double fall) {
  std::vector<Box3> box;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (part[i] >= box.size()) box.resize(part[i] + 1);
    const Vec3 x = nodes.position[i] + motion.displacement[i], way = 2 * dt * motion.velocity[i];
    box[part[i]].add(Box3{x.cwiseMin(x + way), x.cwiseMax(x + way)}.grown(nodes.spacing[i] + 2 * dt * fall));
  }
  for (std::size_t a = 0; a < box.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      if (box[a].meets(box[b])) return true;
  return false;
}

}  // namespace

Obstacles::Obstacles(const Scene& scene) {
  for (const SceneObstacle& o : scene.obstacles) {
    TriangleMesh mesh = o.mesh;
    for (Vec3& p : mesh.vertices) p *= o.scale;
    shapes_.push_back(
        std::make_shared<RigidShape>(mesh.triangles.empty() ? RigidShape::half_space(o.normal) : RigidShape(mesh)));
  }
  if (scene.ground && scene.self_contact)
    shapes_.push_back(std::make_shared<RigidShape>(RigidShape::half_space(scene.ground_normal)));
}

const SurfaceWeights& Obstacles::weights_of(const SurfaceWeights* given, const Body& body, const Solid& solid) {
  if (given) return *given;
  if (!own_) own_.emplace().update(body, solid);
  return *own_;
}

void Obstacles::begin(const Scene& scene, const Body& body, const Solid& solid, const SurfaceWeights* weights,
                      std::span<const Vec3> at, const std::vector<std::uint32_t>& part, const State& motion,
                      double time, double dt, Environment& environment) {
  acting_.clear();
  const bool mutual = scene.bodies.size() > 1 && scene.body_contact && !scene.self_contact;
  if (shapes_.empty() && !mutual) return;
  // As stiff as the same penalty on each node of the lowest layer: acceleration times mass over area; by the nodes
  // there are now, so that a run taken up does the same.
  const Materials& materials = solid.materials();
  std::vector<double> layer(materials.count(), 0), count(layer),
      firmness;  // per material; per node, where there are several
  double spacing = 0, fastest = 0;
  for (std::size_t i = 0; i < solid.size(); ++i) {
    const auto m = materials.number(i);
    layer[m] += solid.mass(NodeId(i)) / (body.nodes.spacing[i] * body.nodes.spacing[i]), ++count[m],
        spacing += body.nodes.spacing[i];
  }
  for (std::size_t m = 0; m < layer.size(); ++m) layer[m] /= count[m];
  spacing /= double(solid.size());
  const double each = layer.size() == 1 ? layer[0] : 1;
  for (std::size_t i = 0; i < solid.size() && layer.size() > 1; ++i) firmness.push_back(layer[materials.number(i)]);
  for (const Vec3& v : motion.velocity) fastest = std::max(fastest, v.norm());
  const double fall = dt * environment.gravity.norm();
  for (std::size_t k = 0; k < shapes_.size(); ++k) {
    const bool ground = k == scene.obstacles.size();
    ObstaclePenaltyOptions options{ground ? scene.ground_stiffness : scene.obstacles[k].stiffness,
                                   ground ? scene.friction : scene.obstacles[k].friction};
    options.pressure *= each;
    Eigen::Isometry3d from = Eigen::Isometry3d::Identity(), to = from;
    if (ground)
      from.translation() = to.translation() = scene.ground_point;
    else
      from = isometry(scene.obstacles[k].pose(time)), to = isometry(scene.obstacles[k].pose(time + dt));
    const double moved = (to.translation() - from.translation()).norm() +
                         shapes_[k]->extent() * Eigen::AngleAxisd(from.linear().transpose() * to.linear()).angle();
    const double reach = 2 * dt * (fastest + fall) + moved + spacing;
    acting_.emplace_back(shapes_[k], options, from, to);
    if (const auto near = near_nodes(*shapes_[k], from.inverse(), body.nodes, motion.displacement, reach);
        std::find(near.begin(), near.end(), 1) != near.end())
      acting_.back().watch(body, weights_of(weights, body, solid), {motion.displacement, at, near}, reach,
                           1e-2 * std::max(dt * fall, moved) + 1e-6 * spacing, firmness);
  }
  if (scene.ground && scene.self_contact) environment.ground = false;
  for (ObstaclePenalty& o : acting_)
    if (!o.empty()) environment.contact.push_back(&o);
  if (!mutual || !parts_meet(body.nodes, part, motion, dt, fall)) return;
  mutual_ = body_contact(body, solid, weights_of(weights, body, solid), part, motion.displacement,
                         {scene.contact_stiffness * each, scene.contact.friction, 4 * dt * (fastest + fall) + spacing,
                          1e-2 * dt * fall + 1e-6 * spacing, firmness});
  if (!mutual_->empty()) environment.contact.push_back(&*mutual_);
}

void Obstacles::reaction(const State& motion, double share, FrameStats& work) const {
  work.obstacle_force.resize(shapes_.size(), Vec3::Zero()), work.obstacle_torque.resize(shapes_.size(), Vec3::Zero());
  for (std::size_t k = 0; k < acting_.size(); ++k) {
    const ObstaclePenalty::Reaction r = acting_[k].reaction(motion.displacement);
    work.obstacle_force[k] += share * r.force, work.obstacle_torque[k] += share * r.torque;
  }
}

}  // namespace geo
