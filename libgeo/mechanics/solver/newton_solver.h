// Newton's method with conjugate gradients on the incremental potential of one implicit step, with
// line search.
#pragma once

#include <vector>

#include "kerf/solid.h"
#include "mechanics/solver/conjugate_gradients.h"
#include "mechanics/solver/finite_rotation.h"
#include "mechanics/solver/incremental_potential.h"
#include "mechanics/solver/momentum_balance.h"
#include "mechanics/solver/predictor.h"
#include "mechanics/solver/two_level_preconditioner.h"

namespace geo {

/// Minimises the potential island by island: an island that has converged costs nothing more.
class NewtonSolver {
 public:
  /// Refers to the problem and to the cache.
  NewtonSolver(const StepProblem& problem, SolverCache& cache);
  /// Minimises; call once. Returns false where Newton's method did not converge: the step is too
  /// long. Adds iterations to `report` and sets its energy.
  bool solve(StepReport& report);
  /// Displacements after the step, once solve() has returned true.
  const std::vector<Vec3>& displacement() const { return at_.u; }
  /// The potential that the step minimised.
  const IncrementalPotential& potential() const { return potential_; }

 private:
  void leave_sleepers();
  double sleeping_energy(const ActiveIslands& awake);
  bool iterate(bool first, StepReport& report);
  void linearise_stale();
  void update_accuracy();
  std::vector<char> unconverged(const std::vector<RigidMotion>& rotations);
  bool line_search(const std::vector<RigidMotion>& rotations, std::vector<char> searching);
  void set_trial(const ActiveIslands& islands, const std::vector<RigidMotion>& rotations,
                 const std::vector<double>& share);

  const StepProblem& problem_;
  IncrementalPotential potential_;
  CentreWeights centres_;
  FiniteRotation rotation_;
  TwoLevelPreconditioner preconditioner_;
  ActiveIslands active_;  // islands that have not converged
  NewtonIterate at_;
  NewtonDirection direction_;
  std::vector<Vec3> trial_, predicted_;  // predicted_: where Newton's method began
  std::vector<double> accuracy_;         // per island, in spacings
  std::vector<double> contact_error_;    // per island: accuracy beyond that of contact, model units
  std::vector<double> length_;           // per island: of the direction, largest over nodes, in spacings
  int iterates_ = 0;
  std::vector<double> moved_;  // per island: distance since its stiffness was computed, in spacings
};

}  // namespace geo
