// Depth max(0, depth_0 − n · (d − d_0)) of relative displacement d, with d_0 that at the beginning.
// Quadratic penalty and lagged Coulomb friction: mechanics/terms/contact_law.h.
#include "contact/response/self_contact_penalty.h"

#include <algorithm>

namespace geo {

void SelfContactPenalty::add(const RelativeStencil& stencil, const Vec3& normal, double depth, double stiffness,
                             const Vec3& start) {
  const std::size_t first = entries_.size();
  contacts_.push_back({first, first + stencil.entries.size(), normal, depth, stiffness,
                       std::max(0.0, -depth) / weight_norm(stencil.entries), start, false});
  entries_.insert(entries_.end(), stencil.entries.begin(), stencil.entries.end());
}

void SelfContactPenalty::reserve(std::span<const RelativeStencil> stencils) {
  std::size_t entries = entries_.size();
  for (const RelativeStencil& stencil : stencils) entries += stencil.entries.size();
  entries_.reserve(entries), contacts_.reserve(contacts_.size() + stencils.size());
}

double SelfContactPenalty::energy(std::size_t k, const Vec3& d) const {
  const Contact& c = contacts_[k];
  const Vec3 moved = d - c.start;
  const double along = c.normal.dot(moved), depth = std::max(0.0, c.depth - along);
  const double penalty = penalty_work(c.stiffness * depth, depth);
  const LaggedFriction f = friction(c);
  return f.acts() ? penalty + f.energy((moved - along * c.normal).norm()) : penalty;
}

Potential::Derivatives SelfContactPenalty::derivatives(std::size_t k, const Vec3& d) {
  Contact& c = contacts_[k];
  const Vec3& n = c.normal;
  const Vec3 moved = d - c.start;
  const double along = n.dot(moved), depth = std::max(0.0, c.depth - along);
  Derivatives result;
  c.pressing = depth > 0;
  if (c.pressing)
    result.force = penalty_force(c.stiffness, depth, n), result.hessian = plane_penalty_hessian(c.stiffness, n);
  if (const LaggedFriction f = friction(c); f.acts())
    f.add(moved - along * n, n * n.transpose(), c.slip, result.force, result.hessian);
  return result;
}

std::size_t SelfContactPenalty::pressing() const {
  return static_cast<std::size_t>(
      std::count_if(contacts_.begin(), contacts_.end(), [](const Contact& c) { return c.pressing; }));
}

}  // namespace geo
