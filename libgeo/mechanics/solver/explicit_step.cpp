#include <algorithm>
#include <cmath>
#include <limits>

#include "kerf/solid.h"
#include "mechanics/solver/ground.h"

namespace geo {

namespace {

// What contact does from now on for h seconds, the given shares of the step; returns how much
// energy that can have brought.
double touch(const Environment& env, State& s, double h, double from, double to,
             const std::vector<double>& inverse_mass) {
  if (env.contact.empty()) return 0;
  const std::vector<Vec3> before = s.velocity;
  for (Potential* p : env.contact) {
    p->begin_substep(s.displacement, from, to);
    p->apply_impulse(s.displacement, h, inverse_mass, s.velocity);
  }
  double brought = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    if (inverse_mass[i] > 0)
      brought += std::abs((s.velocity[i] - before[i]).dot(s.velocity[i] + before[i])) / (2 * inverse_mass[i]);
  return brought;
}

}  // namespace

StepReport Solid::step_explicit(State& state, double dt, const Environment& env) const {
  // No wave crosses a third of the smallest neighbourhood of its material in one substep.
  std::vector<double> finest(materials_.count(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < size(); ++i)
    finest[materials_.index(i)] = std::min(finest[materials_.index(i)], spacing_[i]);
  double limit = std::numeric_limits<double>::infinity(), stiffest = 0;
  for (std::size_t k = 0; k < finest.size(); ++k) {
    const Material& m = materials_[k];
    const double speed = std::sqrt((m.lambda() + 2 * m.mu() + m.volume_term) / m.density);
    limit = std::min(limit, 0.3 * finest[k] / speed), stiffest = std::max(stiffest, m.young);
    if (m.viscosity > 0) limit = std::min(limit, 0.1 * finest[k] * finest[k] * m.density / m.viscosity);
  }
  if (env.ground) limit = std::min(limit, 0.3 / std::sqrt(env.ground_stiffness));
  std::vector<double> inverse_mass(size(), 0);
  for (std::size_t i = 0; i < size(); ++i)
    if (!is_fixed(env, i)) inverse_mass[i] = 1 / mass_[i];
  for (Potential* p : env.contact) {
    p->begin_substep(state.displacement, 0, 1);
    if (const double firmest = p->eigenvalue_bound(inverse_mass); firmest > 0)
      limit = std::min(limit, 0.3 / std::sqrt(firmest));
  }
  StepReport report;
  report.substeps = std::max(1, static_cast<int>(std::ceil(dt / limit)));
  const auto rest = relaxed(state);
  std::vector<Vec3> force;
  // Energy may only come from outside: where it rises beyond what loads and ground can have
  // brought, the step was too long.
  for (int attempt = 0;; ++attempt, report.substeps *= 2) {
    State s = state;
    const double h = dt / report.substeps;
    const auto total = [&] { return report.energy + kinetic_energy(s); };
    bool rose = false;
    double brought = 0;
    report.energy = elastic_force(s.displacement, &force, rest);
    const double begun = total();
    for (int k = 0; k < report.substeps && !rose; ++k) {
      if (k > 0) report.energy = elastic_force(s.displacement, &force, rest);
      for (std::size_t i = 0; i < size(); ++i) {
        if (is_fixed(env, i)) {
          s.velocity[i].setZero();
          continue;
        }
        Vec3& v = s.velocity[i];
        Vec3 outside = mass_[i] * env.gravity;
        if (!env.load.empty()) outside += env.load[i];
        v += h * ((force[i] + outside) / mass_[i] - materials_.of(i).damping * v);
        if (env.ground) {
          const double d = depth(env, i, position_[i] + s.displacement[i]);
          if (d > 0) {
            const double normal = env.ground_normal.dot(v);
            v = normal * env.ground_normal +
                std::max(0.0, 1 - env.friction * h / 0.01) * (v - normal * env.ground_normal);
            v += h * env.ground_stiffness * d * env.ground_normal;
            outside += mass_[i] * env.ground_stiffness * d * env.ground_normal;
          }
        }
        brought += std::abs(h * outside.dot(v));
      }
      brought += touch(env, s, h, double(k) / report.substeps, double(k + 1) / report.substeps, inverse_mass);
      for (std::size_t i = 0; i < size(); ++i) s.displacement[i] += h * s.velocity[i];
    }
    report.energy = elastic_force(s.displacement, nullptr, rest);
    rose = !(total() <= 1.05 * (begun + brought) + 1e-12 * stiffest * volume_[0]);
    if (rose && attempt < 8) continue;
    update_plasticity(s, dt);
    state = std::move(s);
    return report;
  }
}

}  // namespace geo
