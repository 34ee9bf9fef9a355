// Inexact Newton method with backtracking by the parabola through E(0), E'(0) and E(s), the step
// kept between 0.2 and 0.5 of the last (Nocedal and Wright 2006, § 3.5, § 7.1).
#include "mechanics/solver/newton_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mechanics/solver/fixed_nodes.h"

namespace geo {
namespace {

constexpr int max_iterations = 20;  // more are slower than two steps of half the length
constexpr int max_balanced = 8;     // further ones end where displacements are accurate
constexpr int max_halvings = 16;    // of a direction; each trial is at most half the one before
// Spacings that an island may move before its stiffness is recomputed: strains change by about a
// tenth. Measured in docs/decisions/044 and 048.
constexpr double stale_after = 0.1;

bool any(const std::vector<char>& mask) { return std::find(mask.begin(), mask.end(), 1) != mask.end(); }

}  // namespace

NewtonSolver::NewtonSolver(const StepProblem& problem, SolverCache& cache)
    : problem_(problem),
      potential_(problem),
      centres_(potential_),
      rotation_(potential_),
      preconditioner_(problem, cache),
      active_(potential_.islands(), problem.solid.subdomains),
      accuracy_(potential_.islands().count(), problem.accuracy),
      contact_error_(potential_.islands().count(), 0),
      length_(potential_.islands().count(), 0),
      moved_(potential_.islands().count(), std::numeric_limits<double>::max()) {
  direction_.step.assign(problem.solid.size(), Vec3::Zero());
  direction_.residual.resize(potential_.islands().count(), 0);
  leave_sleepers();
}

// Islands that sleep as a whole are not computed.
void NewtonSolver::leave_sleepers() {
  const Islands& islands = potential_.islands();
  std::vector<char> awake(islands.count(), 0);
  for (std::size_t i = 0; i < problem_.solid.size(); ++i)
    if (!is_asleep(problem_.environment, i)) awake[islands.of(i)] = 1;
  active_.select(awake);
}

// Elastic, of the islands that sleep, J.
double NewtonSolver::sleeping_energy(const ActiveIslands& awake) {
  std::vector<char> asleep = awake.mask();
  for (char& mark : asleep) mark = !mark;
  ActiveIslands islands = awake;
  islands.select(asleep);
  return islands.none() ? 0 : potential_.elastic_energy(islands, at_.u);
}

bool NewtonSolver::solve(StepReport& report) {
  const ActiveIslands awake = active_;
  if (awake.none()) {
    at_.u = problem_.start.displacement;
    report.energy = sleeping_energy(awake);
    return true;
  }
  at_ = predict(potential_, rotation_, active_);
  trial_ = predicted_ = at_.u;
  potential_.begin_iterate(active_, at_.value);
  for (int k = 0; k < max_iterations; ++k) {
    if (!iterate(k == 0, report)) return false;
    if (active_.none()) {
      report.energy = sleeping_energy(awake);
      for (std::size_t p = 0; p < awake.mask().size(); ++p)
        if (awake[p]) report.energy += at_.response.energy[p];
      return true;
    }
    potential_.begin_iterate(active_, at_.value);
    potential_.force(active_, at_.u, at_.response, at_.force);
  }
  return false;
}

// One direction and one line search; false where the direction is not finite or an island finds no
// decrease along it.
bool NewtonSolver::iterate(bool first, StepReport& report) {
  linearise_stale();
  preconditioner_.update(potential_, at_.u);
  update_accuracy();
  report.cg +=
      conjugate_gradients(potential_, preconditioner_, active_, at_.force, {first, moved_, accuracy_}, direction_);
  ++report.newton;
  rotation_.conserve_momentum(active_, at_.u, direction_.step);
  MomentumBalance balance(potential_, centres_, active_, at_.u);
  balance.correct(direction_.step);
  active_.maximum(length_, [&](std::size_t i) { return problem_.squared_in_spacings(direction_.step[i], i); });
  active_.take_square_roots(length_);
  for (std::size_t p = 0; p < length_.size(); ++p)
    if (active_[p] && !std::isfinite(length_[p])) return false;
  const std::vector<RigidMotion> rotations = rotation_.rotations(at_.u, direction_.step);
  std::vector<char> searching = unconverged(rotations);
  // A direction that only balances momentum may alternate between contacts without end.
  if (++iterates_ <= max_balanced) balance.mark_unbalanced(direction_.step, iterates_, contact_error_, searching);
  for (std::size_t p = 0; p < searching.size(); ++p) searching[p] = searching[p] && active_[p];
  return line_search(rotations, std::move(searching));
}

void NewtonSolver::update_accuracy() {
  std::vector<double> correction, spacing;
  active_.maximum(spacing, [&](std::size_t i) { return potential_.is_touched(i) ? problem_.solid.spacing[i] : 0; });
  active_.maximum(correction, [&](std::size_t i) { return problem_.squared_in_spacings(at_.u[i] - predicted_[i], i); });
  active_.take_square_roots(correction);
  for (std::size_t p = 0; p < accuracy_.size(); ++p) {
    if (!active_[p]) continue;
    if (potential_.is_bossak()[p]) {
      accuracy_[p] = Bossak::accuracy_share * problem_.accuracy;
      continue;  // nothing touches it
    }
    const double touched = problem_.accuracy_in_contact(spacing[p]);
    accuracy_[p] = problem_.accuracy_after(touched, correction[p]);
    contact_error_[p] = (accuracy_[p] - touched) * spacing[p];
  }
}

void NewtonSolver::linearise_stale() {
  std::vector<char> stale(moved_.size(), 0);
  for (std::size_t p = 0; p < stale.size(); ++p)
    if (active_[p] && moved_[p] > stale_after) {
      stale[p] = 1;
      moved_[p] = 0;
    }
  if (!any(stale)) return;
  ActiveIslands islands = active_;
  islands.select(stale);
  potential_.linearise(islands, at_.response);
}

// Per island: whether its direction needs a line search. Where Newton's error and the residual of
// the solve are below the accuracy, the direction is the last one and is taken as it is: it changes
// the potential by less than rounding shows. Not so a direction that rotates, where rounding may
// strain what is stiff. The elastic energy after a last direction d is known to second order: H d
// is the force, so that Ψ changes by −d · f_Ψ + ½ d · (f − m/τ² d).
std::vector<char> NewtonSolver::unconverged(const std::vector<RigidMotion>& rotations) {
  const std::vector<Vec3>& d = direction_.step;
  std::vector<double> energy_change;
  active_.sum(energy_change, 0.0, [&](std::size_t i) {
    const double squared = potential_.squared_time(potential_.islands().of(i));
    return d[i].dot(0.5 * at_.force[i] - at_.response.force[i] - 0.5 * problem_.solid.mass[i] / squared * d[i]);
  });
  std::vector<char> rotates(length_.size(), 0), searching = active_.mask();
  rotation_.mark_rotating(rotations, rotates);
  for (std::size_t p = 0; p < length_.size(); ++p) {
    if (!active_[p] || rotates[p]) continue;
    const bool is_last = length_[p] * (length_[p] + moved_[p]) < StepProblem::quadratic_tolerance(accuracy_[p]) &&
                         direction_.residual[p] < accuracy_[p];
    if (is_last) {
      searching[p] = 0;
      at_.response.energy[p] += energy_change[p];
    }
  }
  return searching;
}

// Backtracking along the direction of the islands that are `searching`; the others take it whole.
// Advances the iterate, and leaves active the islands that need another direction. False where an
// island finds no decrease.
bool NewtonSolver::line_search(const std::vector<RigidMotion>& rotations, std::vector<char> searching) {
  constexpr double rounding = 1e-14;  // of the potential
  std::vector<double> value, slope, share(searching.size(), 1);
  std::vector<char> active = searching;
  ActiveIslands islands = active_;
  set_trial(islands, rotations, share);
  islands.select(searching);
  islands.sum(slope, 0.0, [&](std::size_t i) { return at_.force[i].dot(direction_.step[i]); });
  for (int halvings = 0; any(searching); ++halvings) {
    islands.select(searching);
    if (halvings > 0) set_trial(islands, rotations, share);
    potential_.evaluate(islands, trial_, value, &at_.response);
    for (std::size_t p = 0; p < searching.size(); ++p) {
      if (!searching[p]) continue;
      if (value[p] <= at_.value[p] + rounding * std::abs(at_.value[p])) {
        searching[p] = 0;
        at_.value[p] = value[p];
        moved_[p] += share[p] * length_[p];
      } else if (halvings == max_halvings) {
        if (!(length_[p] * share[p] < problem_.accuracy)) return false;
        active[p] = searching[p] = 0;
      } else {
        // The minimiser ½ s g / (E(s) − E(0) + s g) of the parabola through both values and the
        // slope −g, over s. Contact makes the potential steep, so the factor may be below ½.
        const double rise = value[p] - at_.value[p] + share[p] * slope[p], least = 0.5 * share[p] * slope[p] / rise;
        share[p] *= std::isfinite(least) ? std::clamp(least, 0.2, 0.5) : 0.5;
      }
    }
  }
  at_.u.swap(trial_);
  trial_ = at_.u;
  active_.select(active);
  return true;
}

void NewtonSolver::set_trial(const ActiveIslands& islands, const std::vector<RigidMotion>& rotations,
                             const std::vector<double>& share) {
  islands.each_node([&](std::size_t i) {
    const double s = share[potential_.islands().of(i)];
    trial_[i] =
        at_.u[i] + s * direction_.step[i] +
        rotations[rotation_.island_of(i)].arc_correction(problem_.solid.position[i] + at_.u[i], direction_.step[i], s);
  });
}

}  // namespace geo
