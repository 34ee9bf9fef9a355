// Pressure of a penalty = stiffness · areal density · depth, areal density = mean of nodal mass /
// spacing²; without a stiffness (1000 ρ |g| + 2 E / h) · depth, as far as a step resolves it.
// Contacts are sought within twice the motion expected in the step, plus a spacing.
#include "simulation/obstacles.h"

#include <algorithm>

#include "geometry/rotation.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

// Slip below this share of the expected motion of a step is regularised, so that what rests sticks.
constexpr double relative_slip = 1e-2;
// The least slip regularisation, in node spacings: for steps in which nothing is expected to move.
constexpr double least_slip = 1e-6;
// A body of height H that stands on its base is H / 1000 deep: pressure over depth is 1000 ρ |g|.
constexpr double standing_heights = 1000;
// Pressure over depth, in E / h: as self-contact (contact/response/penalty_assembly.cpp), so that
// what presses is half as deep as the material between two nodes is compressed.
constexpr double relative_stiffness = 2;
// The greatest stiffness of that share over mass, in 1 / Δt²: a layer of nodes has a period of
// 2π / 4 steps, no shorter than one. Stiffer contacts open and close within the accuracy of
// a solve.
constexpr double resolved_stiffness = 16;

Eigen::Isometry3d isometry(const Pose& p) {
  Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
  at.linear() = p.rotation.toRotationMatrix();
  at.translation() = p.position;
  return at;
}

// A pressure over a depth that stands for all materials, Pa/m, and a factor of it for each node.
struct PenaltyPressure {
  double pressure = 1;
  std::vector<double> factor;  // per node; empty where there is one material
};

// Scales of penalties and search distances in a step.
struct ContactScale {
  std::vector<double> areal_density;  // per material: mean of nodal mass / spacing², kg / model unit²
  std::vector<double> stiff;          // per material: pressure over depth where the scene gives no stiffness, Pa/m
  double spacing = 0;                 // mean, of nodes
  double fastest = 0;                 // of nodes, model units / s
  double fall = 0;                    // velocity that gravity adds in the step
};

// All current nodes count, so that a restored run computes the same.
ContactScale scale_of(const ObjectContactStep& step, const Vec3& gravity) {
  const Materials& materials = step.solid.materials();
  const NodeSet& nodes = step.body.nodes;
  const std::size_t n = step.solid.size();
  ContactScale scale;
  scale.areal_density.assign(materials.count(), 0);
  scale.stiff = scale.areal_density;
  std::vector<double> count(materials.count(), 0), spacing = count;
  for (std::size_t i = 0; i < n; ++i) {
    const auto m = materials.index(i);
    scale.areal_density[m] += step.solid.mass(NodeId(i)) / (nodes.spacing[i] * nodes.spacing[i]);
    spacing[m] += nodes.spacing[i];
    ++count[m];
  }
  for (std::size_t m = 0; m < count.size(); ++m) {
    if (!(count[m] > 0)) continue;
    scale.spacing += spacing[m] / double(n);
    scale.areal_density[m] /= count[m];
    spacing[m] /= count[m];
    scale.stiff[m] = standing_heights * materials[m].density * gravity.norm() +
                     std::min(relative_stiffness * materials[m].young / spacing[m],
                              resolved_stiffness * materials[m].density * spacing[m] / (step.stopping * step.stopping));
  }
  for (const Vec3& v : step.motion.velocity) scale.fastest = std::max(scale.fastest, v.norm());
  scale.fall = step.dt * gravity.norm();
  return scale;
}

// Scenes give stiffness k as acceleration over depth, 1/s². The pressure that accelerates a layer
// of nodes by k d is k ρ_A d, with ρ_A the areal density.
PenaltyPressure pressure_of(double stiffness, const ContactScale& scale, const ObjectContactStep& step) {
  std::vector<double> of = scale.stiff;
  if (stiffness > 0)
    for (std::size_t m = 0; m < of.size(); ++m) of[m] = stiffness * scale.areal_density[m];
  PenaltyPressure result;
  if (of.size() == 1) {
    result.pressure = of[0];
    return result;
  }
  for (std::size_t i = 0; i < step.solid.size(); ++i) result.factor.push_back(of[step.solid.materials().index(i)]);
  return result;
}

}  // namespace

Obstacles::Obstacles(const Scene& scene) {
  for (const SceneObstacle& o : scene.obstacles) {
    TriangleMesh mesh = o.mesh;
    for (Vec3& p : mesh.vertices) p *= o.scale;
    shapes_.push_back(
        std::make_shared<RigidShape>(mesh.triangles.empty() ? RigidShape::half_space(o.normal) : RigidShape(mesh)));
  }
  if (scene.ground) shapes_.push_back(std::make_shared<RigidShape>(RigidShape::half_space(scene.ground_normal)));
}

void Obstacles::add_potentials(const ObjectContactStep& step, Environment& environment) {
  const Scene& scene = step.scene;
  const double dt = step.dt;
  obstacles_.clear();
  if (shapes_.empty()) return;
  const ContactScale scale = scale_of(step, environment.gravity);
  for (std::size_t k = 0; k < shapes_.size(); ++k) {
    const bool ground = k == scene.obstacles.size();
    const PenaltyPressure penalty =
        pressure_of(ground ? scene.ground_stiffness : scene.obstacles[k].stiffness, scale, step);
    const ObstaclePenaltyOptions options{penalty.pressure, ground ? scene.friction : scene.obstacles[k].friction};
    Eigen::Isometry3d from = Eigen::Isometry3d::Identity(), to = from;
    if (ground)
      from.translation() = to.translation() = scene.ground_point;
    else {
      from = isometry(scene.obstacles[k].pose(step.time));
      to = isometry(scene.obstacles[k].pose(step.time + dt));
    }
    const double moved =
        (to.translation() - from.translation()).norm() +
        shapes_[k]->extent() * axis_and_angle(Eigen::Quaterniond(from.linear().transpose() * to.linear())).angle();
    // Twice the way of nodes at their present speed, since forces of the step may accelerate them.
    const double reach = 2 * dt * (scale.fastest + scale.fall) + moved + scale.spacing;
    obstacles_.emplace_back(shapes_[k], options, from, to);
    obstacles_.back().find_contacts(step.weights, step.surface, reach,
                                    relative_slip * std::max(dt * scale.fall, moved) + least_slip * scale.spacing,
                                    penalty.factor);
  }
  for (ObstaclePenalty& o : obstacles_)
    if (!o.empty()) environment.contact.push_back(&o);
}

std::vector<const Potential*> Obstacles::moving() const {
  std::vector<const Potential*> result;
  for (const ObstaclePenalty& o : obstacles_)
    if (o.moves()) result.push_back(&o);
  return result;
}

bool Obstacles::any_moves(const Scene& scene, const TimeStep& step) {
  return std::any_of(scene.obstacles.begin(), scene.obstacles.end(), [&](const SceneObstacle& o) {
    return isometry(o.pose(step.begin)).matrix() != isometry(o.pose(step.end)).matrix();
  });
}

void Obstacles::add_reactions(const State& motion, double share, FrameStats& stats) const {
  stats.obstacle_force.resize(shapes_.size(), Vec3::Zero());
  stats.obstacle_torque.resize(shapes_.size(), Vec3::Zero());
  for (std::size_t k = 0; k < obstacles_.size(); ++k) {
    const ObstaclePenalty::Reaction r = obstacles_[k].reaction(motion.displacement);
    stats.obstacle_force[k] += share * r.force;
    stats.obstacle_torque[k] += share * r.torque;
  }
}

}  // namespace geo
