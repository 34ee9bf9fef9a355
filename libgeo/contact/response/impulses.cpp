// Projected Gauss–Seidel on accumulated impulses λ with compliance s (W: effective inverse mass):
// λ ← max(0, λ − (approach + n · v + s λ) / (W + s)); friction is clamped to |λ_t| ≤ μ λ.
#include "contact/response/impulses.h"

#include <algorithm>

#include "kerf/parallel.h"
#include "mechanics/terms/contact_law.h"

namespace geo {
namespace {

// Impulses accumulated at one contact.
struct ContactImpulse {
  double normal = 0;
  Vec3 friction = Vec3::Zero();
};

// One Gauss–Seidel update of a contact with relative velocity v. Returns the change of its impulse:
// it adds the missing normal speed `deficit`, and stops the slip as far as friction can.
// `inverse_mass`: effective, `softness` included.
Vec3 update_impulse(const Vec3& n, const Vec3& v, double deficit, double softness, double inverse_mass, double friction,
                    ContactImpulse& impulse) {
  const double before = impulse.normal;
  impulse.normal = std::max(0.0, before + deficit / inverse_mass);
  Vec3 change = (impulse.normal - before) * n;
  if (friction > 0) {
    const Vec3 slip = v - n.dot(v) * n;
    Vec3 along = impulse.friction - (slip + softness * impulse.friction) / inverse_mass;
    along -= n.dot(along) * n;
    if (const double bound = friction * impulse.normal, size = along.norm(); size > bound)
      along *= size > 0 ? bound / size : 0.0;
    change += along - impulse.friction;
    impulse.friction = along;
  }
  return change;
}

}  // namespace

std::vector<RelativeStencil> relative_stencils(const SurfaceWeights& weights,
                                               std::span<const ContactConstraint> constraints,
                                               const CoincidentVertices& stands_for,
                                               const std::vector<double>& inverse_mass) {
  std::vector<RelativeStencil> stencils(constraints.size());
  parallel_for(constraints.size(), 64, [&](std::size_t begin, std::size_t end) {
    RelativeStencilBuilder builder(weights, stands_for, inverse_mass);
    for (std::size_t i = begin; i < end; ++i) stencils[i] = builder.make(constraints[i].a, constraints[i].b);
  });
  return stencils;
}

ImpulseStats apply_impulses(const SurfaceWeights& weights, std::span<const ContactConstraint> constraints,
                            const CoincidentVertices& stands_for, const std::vector<double>& inverse_mass,
                            const ImpulseOptions& options, std::vector<Vec3>& velocity) {
  ImpulseStats stats;
  const std::vector<RelativeStencil> stencils = relative_stencils(weights, constraints, stands_for, inverse_mass);
  std::vector<ContactImpulse> impulses(constraints.size());
  for (; stats.sweeps < options.sweeps; ++stats.sweeps) {
    double largest_change = 0, largest_speed = 0;
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      const RelativeStencil& stencil = stencils[i];
      const double softness = options.softness * stencil.inverse_mass_a, soft_mass = stencil.inverse_mass + softness;
      if (!(soft_mass > 0)) continue;
      const Vec3 v = weighted_sum(stencil.entries, velocity);
      const Vec3& n = constraints[i].normal;
      const double deficit = -constraints[i].approach - n.dot(v) - softness * impulses[i].normal;
      if (deficit <= 0 && impulses[i].normal == 0) continue;
      const Vec3 change = update_impulse(n, v, deficit, softness, soft_mass, options.friction, impulses[i]);
      add_impulse(stencil.entries, change, inverse_mass, velocity);
      largest_change = std::max(largest_change, change.norm() * soft_mass);
      largest_speed = std::max(largest_speed, v.norm());
    }
    if (largest_change <= options.tolerance * largest_speed || largest_change == 0) break;
  }
  for (const ContactImpulse& impulse : impulses) stats.touching += impulse.normal > 0;
  return stats;
}

}  // namespace geo
