// Depth max(0, depth_0 − n · (d − d_0)) of relative displacement d, with d_0 that at the beginning.
// Quadratic penalty and lagged Coulomb friction: mechanics/terms/contact_law.h.
#include "contact/response/self_contact_penalty.h"

#include <algorithm>
#include <utility>

#include "kerf/parallel.h"

namespace geo {

void SelfContactPenalty::add(std::span<const Addition> contacts) {
  const std::size_t before = contacts_.size();
  std::size_t entries = entries_.size();
  for (const Addition& c : contacts) {
    const std::size_t first = std::exchange(entries, entries + c.stencil->entries.size());
    contacts_.push_back({.first = first,
                         .end = entries,
                         .normal = c.normal,
                         .depth = c.depth,
                         .stiffness = c.stiffness,
                         .activation_distance = 0,
                         .start = c.start});
  }
  entries_.resize(entries);
  parallel_for(contacts.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::vector<NodeWeight>& stencil = contacts[k].stencil->entries;
      Contact& c = contacts_[before + k];
      c.activation_distance = std::max(0.0, -c.depth) / weight_norm(stencil);
      std::copy(stencil.begin(), stencil.end(), entries_.begin() + static_cast<std::ptrdiff_t>(c.first));
    }
  });
}

double SelfContactPenalty::energy(std::size_t k, const Vec3& d) const {
  const Contact& c = contacts_[k];
  const Vec3 moved = d - c.start;
  const double along = c.normal.dot(moved), depth = std::max(0.0, c.depth - along);
  const double penalty = penalty_work(c.stiffness * depth, depth);
  const LaggedFriction f = friction(c);
  return f.acts() ? penalty + f.energy((moved - along * c.normal).norm()) : penalty;
}

Potential::Derivatives SelfContactPenalty::derivatives(std::size_t k, const Vec3& d) const {
  const Contact& c = contacts_[k];
  const Vec3& n = c.normal;
  const Vec3 moved = d - c.start;
  const double along = n.dot(moved), depth = std::max(0.0, c.depth - along);
  Derivatives result;
  if (depth > 0) {
    result.force = penalty_force(c.stiffness, depth, n);
    result.hessian = plane_penalty_hessian(c.stiffness, n);
  }
  if (const LaggedFriction f = friction(c); f.acts())
    f.add(moved - along * n, n * n.transpose(), c.friction.last_slip, result.force, result.hessian);
  return result;
}

double SelfContactPenalty::begin_iterate(std::size_t k, const Vec3& d) {
  Contact& c = contacts_[k];
  const Vec3 moved = d - c.start;
  const double along = c.normal.dot(moved), depth = std::max(0.0, c.depth - along);
  const Vec3 slip = moved - along * c.normal;
  c.pressing = depth > 0;
  const double change = c.friction.begin_iterate(slip, c.stiffness * depth);
  return options_.friction * change * friction(c).energy_over_bound(slip.norm());
}

std::size_t SelfContactPenalty::pressing() const {
  return static_cast<std::size_t>(
      std::count_if(contacts_.begin(), contacts_.end(), [](const Contact& c) { return c.pressing; }));
}

}  // namespace geo
