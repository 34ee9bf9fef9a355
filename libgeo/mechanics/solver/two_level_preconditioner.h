// The preconditioner of conjugate gradients, additive on two levels: overlapping Schwarz subdomains
// of six or so nodes, and a coarse space in which aggregates of a hundred nodes move rigidly.
#pragma once

#include <optional>
#include <vector>

#include "mechanics/solver/coarse_correction.h"
#include "mechanics/solver/incremental_potential.h"
#include "mechanics/solver/islands.h"
#include "mechanics/solver/schwarz_preconditioner.h"
#include "mechanics/solver/solver_cache.h"

namespace geo {

class TwoLevelPreconditioner {
 public:
  /// Refers to the problem and to the cache, whose inverses it uses and renews.
  TwoLevelPreconditioner(const StepProblem& problem, SolverCache& cache);
  /// First call: builds both levels at u from the potential's Hessian. Later calls only renew the
  /// subdomains of nodes whose blocks contact has changed: elasticity has changed little since.
  void update(const IncrementalPotential& potential, const std::vector<Vec3>& u);
  /// Computes z = M⁻¹ r for the active islands; at() returns it. Precondition: update().
  void apply(const ActiveIslands& active, const std::vector<Vec3>& r);
  /// z at a node.
  Vec3 at(std::size_t node) const { return schwarz_->at(node) + coarse_->at(node); }
  /// The part of z that is in the coarse space, at a node.
  Vec3 coarse_at(std::size_t node) const { return coarse_->at(node); }

 private:
  void build_coarse(const IncrementalPotential& potential, const std::vector<Vec3>& u,
                    const std::vector<Mat3>& nodal_blocks);
  void update_schwarz(const IncrementalPotential& potential, const std::vector<Mat3>& nodal_blocks);

  const StepProblem& problem_;
  SolverCache& cache_;
  std::vector<Moduli> moduli_;      // per material, at small strain
  std::vector<Mat3> nodal_blocks_;  // per node, of the last update()
  std::optional<SchwarzPreconditioner> schwarz_;
  std::optional<CoarseCorrection> coarse_;
};

}  // namespace geo
