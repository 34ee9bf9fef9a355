// The incremental potential of an implicit step (Kane et al. 2000, Li et al. 2020): its minimiser
// is the displacement after the step. Inertia, loads, elasticity and contact; value, gradient,
// Hessian–vector product.
#pragma once

#include <utility>
#include <vector>

#include "mechanics/solver/bossak.h"
#include "mechanics/solver/elastic_potential.h"
#include "mechanics/solver/islands.h"
#include "mechanics/solver/step_problem.h"
#include "mechanics/terms/potential_sum.h"

namespace geo {

/// Bossak's step of a node.
Bossak bossak_step(const StepProblem& problem, std::size_t node);

/// E(u) = Σ ½ m/τ² |u − ũ|² − f · (u − u₀) + Ψ(u) + contact, with the inertial target ũ, the
/// inertial time τ and loads f. Backward Euler: ũ = u₀ + Δt v₀ (less damping), τ = Δt. Bossak's
/// scheme: ũ = u₀ + Δt v₀ + Δt²/8 a₀ (less damping), τ² = 3/8 Δt² (bossak.h). Fixed nodes have ũ =
/// u₀ and no gradient. Values are those of islands.
class IncrementalPotential {
 public:
  /// Refers to the problem and what it refers to.
  explicit IncrementalPotential(const StepProblem& problem);

  /// The decoupled subsystems of the step.
  const Islands& islands() const { return islands_; }
  /// The step itself.
  const StepProblem& problem() const { return problem_; }
  /// The contact of the step.
  const PotentialSum& contact() const { return contact_; }
  /// ũ per node: where inertia alone takes it.
  const std::vector<Vec3>& inertial_target() const { return target_; }
  /// Whether the islands' step is Bossak's, per island.
  const std::vector<char>& is_bossak() const { return bossak_; }
  /// τ² of an island, s²: a force f on a mass m moves it by τ² f / m.
  double squared_time(std::size_t island) const {
    const double squared = problem_.dt * problem_.dt;
    return bossak_[island] ? Bossak::inertial_share * squared : squared;
  }
  /// Gravity and load per node, N.
  const std::vector<Vec3>& load() const { return load_; }

  /// value[island] = E(u), J, for the active islands; nothing where none is active. `response`,
  /// where given, receives the elastic response that force() and linearise() need.
  void evaluate(const ActiveIslands& active, const std::vector<Vec3>& u, std::vector<double>& value,
                ElasticResponse* response = nullptr);
  /// The elastic energy of the active islands at u, J.
  double elastic_energy(const ActiveIslands& active, const std::vector<Vec3>& u);
  /// Begins a Newton iterate where the active islands were at their last evaluate(). From the
  /// second one on, takes the bounds of friction there, and adds what this changes of E to `value`.
  void begin_iterate(const ActiveIslands& active, std::vector<double>& value) {
    contact_.begin_iterate(islands_.of_nodes(), active.mask(), value);
  }
  /// force = −∂E/∂u, N, at the nodes of active islands. Precondition: their last evaluate() was at
  /// u, with `response`.
  void force(const ActiveIslands& active, const std::vector<Vec3>& u, const ElasticResponse& response,
             std::vector<Vec3>& force);

  /// Recomputes the elastic part of the Hessian for the active islands from a response of
  /// evaluate().
  void linearise(const ActiveIslands& active, const ElasticResponse& response) { elastic_.linearise(active, response); }
  /// out = H p, N, and curvature[island] = p · H p, J, for the active islands, with the Hessian of
  /// the last linearise() and of contact at the last force().
  void multiply(const ActiveIslands& active, const std::vector<Vec3>& p, std::vector<Vec3>& out,
                std::vector<double>& curvature);

  /// Elastic stiffness of the last linearise().
  const PointStiffness& point_stiffness() const { return elastic_.stiffness(); }
  /// 3×3 blocks per node, N/m: all of the Hessian but elasticity, contact by its block diagonal.
  std::vector<Mat3> nodal_blocks_with_contact() const;
  /// Per node: 1 where contact, or another potential that is not smooth, has acted on its island.
  std::vector<std::uint8_t> interrupted() const;
  /// Whether contact acts on a node, or has done so in this step.
  bool is_touched(std::size_t node) const { return contact_.acts_on(node); }

 private:
  std::vector<std::pair<std::uint32_t, std::uint32_t>> coupled_components() const;
  std::vector<char> smooth_islands() const;
  double nodal_energy(std::size_t node, const Vec3& u) const;

  const StepProblem& problem_;
  PotentialSum contact_;
  Islands islands_;
  ElasticPotential elastic_;
  std::vector<char> bossak_;  // per island
  std::vector<Vec3> target_, load_;
  std::vector<double> inertia_;  // per node, N/m: its share of the Hessian's diagonal
};

}  // namespace geo
