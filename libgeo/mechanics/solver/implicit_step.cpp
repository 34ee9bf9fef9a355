// Solid::step_implicit() of kerf/solid.h. The implicit time step: backward Euler or Bossak's
// scheme, with steps halved where Newton's method does not converge.
#include <optional>

#include "kerf/parallel.h"
#include "kerf/potential.h"
#include "kerf/solid.h"
#include "mechanics/solver/debris.h"
#include "mechanics/solver/elastic_potential.h"
#include "mechanics/solver/fixed_nodes.h"
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
  ImplicitScheme scheme;
  SolverCache& cache;
  StepReport& report;
};

// Motion at the end of h seconds that Newton's method has found. Fixed nodes go on with backward
// Euler: what moves them is not their acceleration.
// Bossak's scheme goes on from an acceleration without drag, which it has beside it.
void take(const WholeStep& whole, double h, const StepProblem& problem, const NewtonSolver& solver) {
  State& state = whole.state;
  const IncrementalPotential& potential = solver.potential();
  std::vector<std::uint8_t> interrupted;
  if (whole.scheme == ImplicitScheme::bossak) interrupted = potential.interrupted();
  state.acceleration.resize(whole.solid.size());
  for (std::size_t i = 0; i < whole.solid.size(); ++i) {
    const Vec3& u = solver.displacement()[i];
    if (potential.is_bossak()[potential.islands().of(i)] && !is_fixed(whole.environment, i)) {
      const Bossak step = bossak_step(problem, i);
      state.acceleration[i] = step.acceleration_after(u);
      state.velocity[i] = step.velocity_after(state.acceleration[i]);
      continue;
    }
    const Vec3 velocity = (u - state.displacement[i]) / h;
    Vec3 before = state.velocity[i];
    if (!interrupted.empty() && !interrupted[i]) before /= 1 + whole.solid.materials.of(i).damping * h;
    state.acceleration[i] = (velocity - before) / h;
    state.velocity[i] = velocity;
  }
  state.displacement = solver.displacement();
  whole.solid.update_plasticity(state, h);
}

// Takes the smooth mark from what contact has acted on. Returns whether Bossak's scheme was used
// there.
bool interrupt(const IncrementalPotential& potential, std::vector<std::uint8_t>& smooth) {
  const std::vector<std::uint8_t> interrupted = potential.interrupted();
  bool too_late = false;
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    if (!interrupted[i]) continue;
    too_late = too_late || potential.is_bossak()[potential.islands().of(i)];
    smooth[i] = 0;
  }
  return too_late;
}

// Advances by h seconds, `from` seconds after the beginning of the whole step. Islands that contact
// has acted on make the step again, by backward Euler.
void advance(const WholeStep& whole, double from, double h) {
  State& state = whole.state;
  const bool is_bossak = whole.scheme == ImplicitScheme::bossak;
  const bool is_known = state.smooth.size() == whole.solid.size() && state.acceleration.size() == whole.solid.size();
  std::vector<std::uint8_t> smooth = is_bossak && is_known ? state.smooth : std::vector<std::uint8_t>();
  const StepProblem problem{.solid = whole.solid,
                            .start = state,
                            .dt = h,
                            .environment = whole.environment,
                            .accuracy = whole.accuracy,
                            .smooth = smooth};
  std::optional<NewtonSolver> solver;
  bool found = false;
  do {
    for (Potential* p : whole.environment.contact)
      p->begin_substep(state.displacement, from / whole.dt, (from + h) / whole.dt);
    solver.emplace(problem, whole.cache);
    found = solver->solve(whole.report);
  } while (found && !smooth.empty() && interrupt(solver->potential(), smooth));
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
  take(whole, h, problem, *solver);
  if (!is_bossak) return;
  // Islands that nothing has interrupted in this step go on from it in the next.
  state.smooth = solver->potential().interrupted();
  for (std::size_t i = 0; i < state.smooth.size(); ++i)
    state.smooth[i] = !state.smooth[i] && !is_fixed(whole.environment, i);
}

// Debris moves as rigid bodies, whose corrections no acceleration holds.
void interrupt_debris(const std::vector<Vec3>& velocity_before, State& state) {
  for (std::size_t i = 0; i < state.smooth.size(); ++i)
    if (state.velocity[i] != velocity_before[i]) state.smooth[i] = 0;
}

}  // namespace

StepReport Solid::step_implicit(State& state, double dt, const Environment& environment, double accuracy,
                                Division division, ImplicitScheme scheme) {
  StepReport report;
  const SolidDiscretisation& solid = *discretisation_;
  advance({.solid = solid,
           .state = state,
           .dt = dt,
           .environment = environment,
           .accuracy = accuracy,
           .division = division,
           .scheme = scheme,
           .cache = *cache_,
           .report = report},
          0, dt);
  if (!report.converged) return report;
  if (solid.is_plastic()) report.energy = solid.elastic_energy(state.displacement, nullptr, solid.relaxation_of(state));
  if (scheme != ImplicitScheme::bossak) state.smooth.clear();
  const std::vector<Vec3> velocity = state.smooth.empty() ? std::vector<Vec3>() : state.velocity;
  keep_debris_rigid(solid, environment.fixed, state);
  interrupt_debris(velocity, state);
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
