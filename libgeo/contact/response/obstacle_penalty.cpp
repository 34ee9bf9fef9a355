// Vertices are evaluated in the obstacle's frame by its exact distance field (rigid_shape.h). Slip
// is measured from where the vertex would be had it stuck to the obstacle.
#include "contact/response/obstacle_penalty.h"

#include <algorithm>

#include "geometry/rotation.h"
#include "kerf/parallel.h"
#include "mechanics/terms/weighted_sums.h"

namespace geo {

ObstaclePenalty::ObstaclePenalty(std::shared_ptr<const RigidShape> shape, const ObstaclePenaltyOptions& options,
                                 const Eigen::Isometry3d& from, const Eigen::Isometry3d& to)
    : shape_(std::move(shape)), options_(options), from_(from), to_(to), now_(to) {}

// Calls use(contact number, displacement of its vertex) for every contact, from any thread.
template <class Use>
void ObstaclePenalty::for_each_displacement(const std::vector<Vec3>& u, const Use& use) const {
  for_each_weighted_sum(
      contacts_.size(), u, [&](std::size_t k) { return contacts_[k].weights; }, use);
}

// Pose of the obstacle at a share of the step: slerp of rotations, straight path of the origin.
Eigen::Isometry3d ObstaclePenalty::pose(double share) const {
  if (share <= 0) return from_;
  if (share >= 1) return to_;
  Eigen::Isometry3d p = Eigen::Isometry3d::Identity();
  p.linear() =
      rotation_between(Eigen::Quaterniond(from_.linear()), Eigen::Quaterniond(to_.linear()), share).toRotationMatrix();
  p.translation() = (1 - share) * from_.translation() + share * to_.translation();
  return p;
}

void ObstaclePenalty::find_contacts(const SurfaceWeights& weights, std::span<const Vec3> surface, double reach,
                                    double slip_regularisation, std::span<const double> pressure_factor) {
  slip_regularisation_ = slip_regularisation;
  sum_ = {};
  substep_begin_ = substep_end_ = 0;
  const Eigen::Isometry3d to_local = from_.inverse();
  std::vector<std::uint8_t> reaches(weights.size(), 0);
  parallel_for(reaches.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      reaches[v] = weights.alive(v) && !weights.stencil(v).empty() && shape_->near(to_local * surface[v], reach);
  });
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < reaches.size(); ++v)
    if (reaches[v]) vertices.push_back(v);
  contacts_.resize(vertices.size());
  parallel_for(contacts_.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto v = vertices[i];
      Contact& c = contacts_[i];
      c = {};
      c.weights = weights.stencil(v);
      c.weight_norm = weights.norm(v);
      c.rest = weights.rest(v) + weights.rotated(v);
      c.displacement = surface[v] - c.rest;
      const double factor = pressure_factor.empty() ? 1 : pressure_factor[weights.heaviest()[v]];
      c.stiffness = options_.pressure * factor * weights.area(v);
    }
  });
}

void ObstaclePenalty::begin_substep(const std::vector<Vec3>& u, double from, double to) {
  if (from <= 0) {
    sum_ = {};
    impulses_ = false;
  } else if (from == substep_end_ && !impulses_)
    add_reaction(u, sum_);
  const Eigen::Isometry3d start = pose(from), to_local = start.inverse();
  substep_begin_ = from;
  substep_end_ = to;
  now_ = pose(to);
  const auto begin_contact = [&](std::size_t k, const Vec3& displacement) {
    Contact& c = contacts_[k];
    c.start = c.rest + displacement;
    const Vec3 local = to_local * c.start;
    const RigidShape::Field field = shape_->at(local);
    c.distance = field.distance;
    const double normal = c.stiffness * std::max(0.0, -field.distance);
    c.friction.begin_substep(normal, normal > 0 ? NormalForce::balanced : NormalForce::estimated);
    c.normal = start.linear() * field.normal;
    c.stuck = now_ * local;
    c.activation_distance = std::max(0.0, c.distance - (c.start - c.stuck).norm()) / c.weight_norm;
  };
  if (from > 0) return for_each_displacement(u, begin_contact);
  parallel_for(contacts_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) begin_contact(k, contacts_[k].displacement);
  });
}

// The distance field at a vertex that is at y, world coordinates; distance 0 outside.
RigidShape::Field ObstaclePenalty::penetration(const Contact& c, const Vec3& y) const {
  // The distance has shrunk at most by the vertex' motion relative to the obstacle.
  if (c.distance > 0 && (y - c.stuck).norm() < c.distance) return {};
  RigidShape::Field field = shape_->at(now_.inverse() * y);
  if (!(field.distance < 0)) return {};
  const Mat3 turn = now_.linear();
  return {field.distance, turn * field.normal, turn * field.half_square_hessian * turn.transpose()};
}

// Slip along the obstacle of a vertex that is at y, since the substep began.
Vec3 ObstaclePenalty::slip(const Contact& c, const Vec3& y) {
  const Vec3 moved = y - c.stuck;
  return moved - c.normal.dot(moved) * c.normal;
}

double ObstaclePenalty::energy(std::size_t k, const Vec3& d) const {
  const Contact& c = contacts_[k];
  const Vec3 y = c.rest + d;
  const double distance = penetration(c, y).distance, penalty = penalty_energy(c.stiffness, distance * distance);
  const LaggedFriction f = friction(c);
  return f.acts() ? penalty + f.energy(slip(c, y).norm()) : penalty;
}

Potential::Derivatives ObstaclePenalty::derivatives(std::size_t k, const Vec3& d) const {
  const Contact& c = contacts_[k];
  const Vec3 y = c.rest + d;
  const RigidShape::Field field = penetration(c, y);
  Derivatives result{penalty_force(c.stiffness, -field.distance, field.normal),
                     penalty_hessian(c.stiffness, field.half_square_hessian)};
  if (const LaggedFriction f = friction(c); f.acts())
    f.add(slip(c, y), c.normal * c.normal.transpose(), c.friction.last_slip, result.force, result.hessian);
  return result;
}

double ObstaclePenalty::begin_iterate(std::size_t k, const Vec3& d) {
  Contact& c = contacts_[k];
  const Vec3 y = c.rest + d, along = slip(c, y);
  const double change = c.friction.begin_iterate(along, c.stiffness * std::max(0.0, -penetration(c, y).distance));
  return options_.friction * change * friction(c).energy_over_bound(along.norm());
}

void ObstaclePenalty::apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                                    std::vector<Vec3>& velocity) {
  const Eigen::Isometry3d start = pose(substep_begin_);
  std::vector<RigidShape::Field> fields(contacts_.size());
  const double share = substep_end_ - substep_begin_;
  impulses_ = true;
  for_each_displacement(
      u, [&](std::size_t k, const Vec3& d) { fields[k] = penetration(contacts_[k], contacts_[k].rest + d); });
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = contacts_[k];
    const RigidShape::Field& field = fields[k];
    if (!(field.distance < 0)) continue;
    const double inverse = effective_inverse_mass(c.weights, inverse_mass);
    if (!(inverse > 0)) continue;
    const Vec3 normal_impulse = penalty_force(h * c.stiffness, -field.distance, field.normal);
    const Vec3 y = c.rest + weighted_sum(c.weights, u);
    const Vec3 obstacle_velocity = (now_ * (start.inverse() * y) - y) / h;  // of the obstacle's point at y
    Vec3 slip = weighted_sum(c.weights, velocity) - obstacle_velocity;
    slip -= field.normal.dot(slip) * field.normal;
    const double factor = friction_impulse_factor(options_.friction * normal_impulse.norm(), slip.norm(), inverse);
    const Vec3 impulse = normal_impulse - factor * slip;
    add_impulse(c.weights, impulse, inverse_mass, velocity);
    sum_.force -= share / h * impulse;
    sum_.torque -= share / h * (y - now_.translation()).cross(impulse);
  }
}

// Adds the reaction of this substep at displacements u, times its share of the step.
void ObstaclePenalty::add_reaction(const std::vector<Vec3>& u, Reaction& sum) const {
  const double share = substep_end_ - substep_begin_;
  std::vector<Reaction> on_body(contacts_.size());
  for_each_displacement(u, [&](std::size_t k, const Vec3& d) {
    const Vec3 f = share * derivatives(k, d).force;
    on_body[k] = {f, (contacts_[k].rest + d - now_.translation()).cross(f)};
  });
  for (const Reaction& r : on_body) {
    sum.force -= r.force;
    sum.torque -= r.torque;
  }
}

ObstaclePenalty::Reaction ObstaclePenalty::reaction(const std::vector<Vec3>& u) const {
  Reaction all = sum_;
  if (!impulses_) add_reaction(u, all);
  return all;
}

double ObstaclePenalty::depth(const std::vector<Vec3>& u) const {
  double deepest = 0;
  for (const Contact& c : contacts_)
    deepest = std::max(deepest, -penetration(c, c.rest + weighted_sum(c.weights, u)).distance);
  return deepest;
}

}  // namespace geo
