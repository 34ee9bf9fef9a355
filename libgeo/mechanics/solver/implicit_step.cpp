// Solid::step_implicit() of kerf/solid.h. The implicit time step: backward Euler, with steps halved
// where Newton's method does not converge.
#include "kerf/parallel.h"
#include "kerf/potential.h"
#include "kerf/solid.h"
#include "mechanics/solver/debris.h"
#include "mechanics/solver/elastic_potential.h"
#include "mechanics/solver/newton_solver.h"
#include "mechanics/solver/solver_cache.h"

namespace geo {
namespace {

constexpr double shortest_substep = 1.0 / 1024;  // of the whole step; a step as short is taken converged or not

// The whole step, of which substeps are halves of halves.
struct WholeStep {
  const SolidDiscretisation& solid;
  State& state;
  double dt;
  const Environment& environment;
  double accuracy;
  Division division;
  SolverCache& cache;
  StepReport& report;
};

// Advances by h seconds, `from` seconds after the beginning of the whole step.
void advance(const WholeStep& whole, double from, double h) {
  State& state = whole.state;
  for (Potential* p : whole.environment.contact)
    p->begin_substep(state.displacement, from / whole.dt, (from + h) / whole.dt);
  const StepProblem problem{
      .solid = whole.solid, .start = state, .dt = h, .environment = whole.environment, .accuracy = whole.accuracy};
  NewtonSolver solver(problem, whole.cache);
  const bool found = solver.solve(whole.report);
  if (!found && whole.division == Division::refused) {
    whole.report.converged = false;
    return;
  }
  if (!found && h > whole.dt * shortest_substep) {
    advance(whole, from, h / 2);
    advance(whole, from + h / 2, h / 2);
    return;
  }
  ++whole.report.substeps;
  state.acceleration.resize(whole.solid.size());
  for (std::size_t i = 0; i < whole.solid.size(); ++i) {
    const Vec3 velocity = (solver.displacement()[i] - state.displacement[i]) / h;
    state.acceleration[i] = (velocity - state.velocity[i]) / h;
    state.velocity[i] = velocity;
  }
  state.displacement = solver.displacement();
  whole.solid.update_plasticity(state, h);
}

}  // namespace

StepReport Solid::step_implicit(State& state, double dt, const Environment& environment, double accuracy,
                                Division division) {
  StepReport report;
  const SolidDiscretisation& solid = *discretisation_;
  advance({.solid = solid,
           .state = state,
           .dt = dt,
           .environment = environment,
           .accuracy = accuracy,
           .division = division,
           .cache = *cache_,
           .report = report},
          0, dt);
  if (!report.converged) return report;
  if (solid.is_plastic()) report.energy = solid.elastic_energy(state.displacement, nullptr, solid.relaxation_of(state));
  keep_debris_rigid(solid, environment.fixed, state);
  set_rotations(state);
  return report;
}

std::vector<Vec3> Solid::stiffness_product(const std::vector<Vec3>& u, const std::vector<Vec3>& p) const {
  const SolidDiscretisation& solid = *discretisation_;
  const State at_rest{.displacement = u, .velocity = std::vector<Vec3>(size(), Vec3::Zero())};
  const Environment none;
  const StepProblem problem{.solid = solid, .start = at_rest, .dt = 1, .environment = none, .accuracy = 1};
  const Islands islands(solid.points, solid.component, solid.components, {});
  const ActiveIslands all(islands, solid.subdomains);
  ElasticPotential elastic(problem);
  ElasticResponse response;
  std::vector<double> energy(islands.count(), 0);
  elastic.evaluate(all, u, energy, &response);
  elastic.linearise(all, response);
  elastic.multiply(all, p);
  std::vector<Vec3> product(size());
  all.each_node([&](std::size_t i) { product[i] = elastic.product_at(i); });
  if (solid.penalty) solid.penalty->add(solid.mls, p, &product);
  return product;
}

}  // namespace geo
