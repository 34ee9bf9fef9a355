// Depth max(0, −n · (offset + d)) of relative displacement d, penalised quadratically. Lagged
// friction acts on the slip (I − n nᵀ) (d − d_start). Formulas: mechanics/terms/contact_law.h.
#include "contact/response/body_contact_penalty.h"

#include <algorithm>

namespace geo {

void BodyContactPenalty::begin_substep(const std::vector<Vec3>& u, double, double) {
  for (Contact& c : contacts_) {
    c.start = weighted_sum(c.stencil, u);
    c.friction.begin_substep(c.stiffness * c.depth(c.start));
  }
}

double BodyContactPenalty::energy(std::size_t k, const Vec3& d) const {
  const Contact& c = contacts_[k];
  const double depth = c.depth(d), penalty = penalty_energy(c.stiffness, depth * depth);
  const LaggedFriction f = friction(c);
  return f.acts() ? penalty + f.energy(c.tangential(d - c.start).norm()) : penalty;
}

Potential::Derivatives BodyContactPenalty::derivatives(std::size_t k, const Vec3& d) const {
  const Contact& c = contacts_[k];
  const double depth = c.depth(d);
  const Mat3 projector = c.normal * c.normal.transpose();
  Derivatives result{penalty_force(c.stiffness, depth, c.normal),
                     depth > 0 ? penalty_hessian(c.stiffness, projector) : Mat3(Mat3::Zero())};
  if (const LaggedFriction f = friction(c); f.acts())
    f.add(c.tangential(d - c.start), projector, c.friction.last_slip, result.force, result.hessian);
  return result;
}

double BodyContactPenalty::begin_iterate(std::size_t k, const Vec3& d) {
  Contact& c = contacts_[k];
  const Vec3 slip = c.tangential(d - c.start);
  const double change = c.friction.begin_iterate(slip, c.stiffness * c.depth(d));
  return friction_ * change * friction(c).energy_over_bound(slip.norm());
}

void BodyContactPenalty::apply_impulse(const std::vector<Vec3>& u, double h, const std::vector<double>& inverse_mass,
                                       std::vector<Vec3>& velocity) {
  for (const Contact& c : contacts_) {
    const double normal_impulse = h * c.stiffness * c.depth(weighted_sum(c.stencil, u));
    const double inverse = effective_inverse_mass(c.stencil, inverse_mass);
    if (!(normal_impulse > 0 && inverse > 0)) continue;
    const Vec3 slip = c.tangential(weighted_sum(c.stencil, velocity));
    const double factor = friction_impulse_factor(friction_ * normal_impulse, slip.norm(), inverse);
    add_impulse(c.stencil, normal_impulse * c.normal - factor * slip, inverse_mass, velocity);
  }
}

double BodyContactPenalty::depth(const std::vector<Vec3>& u) const {
  double deepest = 0;
  for (const Contact& c : contacts_) deepest = std::max(deepest, c.depth(weighted_sum(c.stencil, u)));
  return deepest;
}

}  // namespace geo
