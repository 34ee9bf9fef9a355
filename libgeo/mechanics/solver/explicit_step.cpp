// Solid::step_explicit() of kerf/solid.h. The explicit time step: symplectic Euler with substeps
// that resolve the fastest wave.
#include <algorithm>
#include <cmath>
#include <limits>

#include "kerf/potential.h"
#include "kerf/solid.h"
#include "mechanics/solver/debris.h"
#include "mechanics/solver/fixed_nodes.h"
#include "mechanics/solver/solid_discretisation.h"

namespace geo {
namespace {

// One step of dt seconds, tried with several numbers of substeps.
struct ExplicitStep {
  const SolidDiscretisation& solid;
  const Environment& environment;
  double dt;
  std::vector<double> inverse_mass;         // per node; zero where fixed
  std::vector<PointRelaxation> relaxation;  // of plastic strain and prestretch
};

// Duration of a stable substep. No pressure wave, of speed √((λ + 2 μ + k_v) / ρ), crosses 0.3 of
// the smallest spacing h of its material. No penalty of frequency ω turns by more than 0.3 rad.
// The same holds for the as-rigid-as-possible energy, whose eigenvalues are at most twice its
// diagonal. Viscosity η diffuses momentum: 0.1 h² ρ / η is below the bound h² ρ / (6 η) of a
// regular grid.
double stable_duration(const ExplicitStep& step, const std::vector<Vec3>& u) {
  const SolidDiscretisation& solid = step.solid;
  const Environment& env = step.environment;
  std::vector<double> finest(solid.materials.count(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < solid.size(); ++i) {
    double& own = finest[solid.materials.index(i)];
    own = std::min(own, solid.spacing[i]);
  }
  double limit = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < finest.size(); ++k) {
    const Material& m = solid.materials[k];
    const double speed = std::sqrt((m.lambda() + 2 * m.mu() + m.volume_term) / m.density);
    limit = std::min(limit, 0.3 * finest[k] / speed);
    if (m.viscosity > 0) limit = std::min(limit, 0.1 * finest[k] * finest[k] * m.density / m.viscosity);
  }
  std::vector<double> diagonal(solid.as_rigid.empty() ? 0 : solid.size(), 0);
  solid.as_rigid.add_diagonal(diagonal);
  for (std::size_t i = 0; i < diagonal.size(); ++i)
    if (diagonal[i] > 0) limit = std::min(limit, 0.3 / std::sqrt(2 * diagonal[i] * step.inverse_mass[i]));
  for (Potential* p : env.contact) {
    p->begin_substep(u, 0, 1);
    if (const double firmest = p->eigenvalue_bound(step.inverse_mass); firmest > 0)
      limit = std::min(limit, 0.3 / std::sqrt(firmest));
  }
  return limit;
}

// Contact impulses of a substep of h seconds, from one share of the step to another. Returns a
// bound of the energy, J, that they have added.
double apply_contact(const ExplicitStep& step, State& s, double h, double from, double to) {
  if (step.environment.contact.empty()) return 0;
  const std::vector<Vec3> before = s.velocity;
  for (Potential* p : step.environment.contact) {
    p->begin_substep(s.displacement, from, to);
    p->apply_impulse(s.displacement, h, step.inverse_mass, s.velocity);
  }
  double added = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    if (step.inverse_mass[i] > 0)
      added += std::abs((s.velocity[i] - before[i]).dot(s.velocity[i] + before[i])) / (2 * step.inverse_mass[i]);
  return added;
}

// Velocities after h seconds under elastic forces and loads. Adds to `added` a bound of the energy,
// J, that loads have brought.
void apply_forces(const ExplicitStep& step, const std::vector<Vec3>& force, double h, State& s, double& added) {
  const SolidDiscretisation& solid = step.solid;
  const Environment& env = step.environment;
  for (std::size_t i = 0; i < solid.size(); ++i) {
    if (is_fixed(env, i)) {
      s.velocity[i].setZero();
      continue;
    }
    Vec3& v = s.velocity[i];
    Vec3 external = solid.mass[i] * env.gravity;
    if (!env.load.empty()) external += env.load[i];
    v += h * ((force[i] + external) / solid.mass[i] - solid.materials.of(i).damping * v);
    added += std::abs(h * external.dot(v));
  }
}

}  // namespace

StepReport Solid::step_explicit(State& state, double dt, const Environment& environment) {
  constexpr int max_attempts = 8;
  const SolidDiscretisation& solid = *discretisation_;
  ExplicitStep step{.solid = solid,
                    .environment = environment,
                    .dt = dt,
                    .inverse_mass = std::vector<double>(size(), 0),
                    .relaxation = {}};
  for (std::size_t i = 0; i < size(); ++i)
    if (!is_fixed(environment, i)) step.inverse_mass[i] = 1 / solid.mass[i];
  StepReport report;
  report.substeps = std::max(1, static_cast<int>(std::ceil(dt / stable_duration(step, state.displacement))));
  step.relaxation = solid.relaxation_of(state);
  double stiffest = 0;
  for (const Material& m : solid.materials.all()) stiffest = std::max(stiffest, m.young);
  const double rounding = 1e-12 * stiffest * solid.volume[0];  // of energies, J
  // Only external actions bring energy. Where it rises by more than they can have brought, substeps
  // are too long. A margin of 5 % admits the oscillation of energy in symplectic Euler steps.
  for (int attempt = 0;; ++attempt, report.substeps *= 2) {
    State s = state;
    std::vector<Vec3> force;
    const double h = dt / report.substeps;
    const auto total = [&] { return report.energy + kinetic_energy(s); };
    double added = 0;
    report.energy = solid.elastic_energy(s.displacement, &force, step.relaxation);
    const double initial = total();
    for (int k = 0; k < report.substeps; ++k) {
      if (k > 0) report.energy = solid.elastic_energy(s.displacement, &force, step.relaxation);
      apply_forces(step, force, h, s, added);
      added += apply_contact(step, s, h, double(k) / report.substeps, double(k + 1) / report.substeps);
      for (std::size_t i = 0; i < size(); ++i) s.displacement[i] += h * s.velocity[i];
    }
    report.energy = solid.elastic_energy(s.displacement, nullptr, step.relaxation);
    const bool rose = !(total() <= 1.05 * (initial + added) + rounding);
    if (rose && attempt < max_attempts) continue;
    solid.update_plasticity(s, dt);
    state = std::move(s);
    keep_debris_rigid(solid, environment.fixed, state);
    set_rotations(state);
    return report;
  }
}

}  // namespace geo
