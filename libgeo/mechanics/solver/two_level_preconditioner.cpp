// M⁻¹ r = Σ_p W_p K_p⁻¹ W_p r + 0.4 P (Pᵀ K P)⁻¹ Pᵀ r: Schwarz subdomains and coarse correction,
// built and applied in parallel.
#include "mechanics/solver/two_level_preconditioner.h"

#include <algorithm>

#include "kerf/parallel.h"

namespace geo {

TwoLevelPreconditioner::TwoLevelPreconditioner(const StepProblem& problem, SolverCache& cache)
    : problem_(problem), cache_(cache) {
  for (const Material& m : problem.solid.materials.all())
    moduli_.push_back({float(m.mu() + m.viscosity / problem.dt / 2), float(m.lambda() + m.volume_term)});
}

void TwoLevelPreconditioner::build_coarse(const IncrementalPotential& potential, const std::vector<Vec3>& u,
                                          const std::vector<Mat3>& nodal_blocks) {
  if (coarse_) return;
  const SolidDiscretisation& solid = problem_.solid;
  std::vector<Vec3> at(solid.size());
  for (std::size_t i = 0; i < at.size(); ++i) at[i] = solid.position[i] + u[i];
  coarse_.emplace(solid.aggregates, at, problem_.environment.fixed);
  coarse_->factor(solid.points, potential.point_stiffness(), moduli_, solid.coarse_point_stride(), nodal_blocks);
}

void TwoLevelPreconditioner::update_schwarz(const IncrementalPotential& potential,
                                            const std::vector<Mat3>& nodal_blocks) {
  const SolidDiscretisation& solid = problem_.solid;
  const std::vector<std::uint8_t>& fixed = problem_.environment.fixed;
  if (!schwarz_) {
    const SchwarzPreconditioner::Input input{.materials = solid.materials,
                                             .moduli = moduli_,
                                             .modes = potential.point_stiffness().modes,
                                             .blocks = nodal_blocks,
                                             .fixed = fixed};
    schwarz_.emplace(solid.subdomains, input, cache_.inverses);
    return;
  }
  std::vector<std::uint32_t> changed;
  for (std::size_t i = 0; i < nodal_blocks.size(); ++i)
    if (nodal_blocks[i] != nodal_blocks_[i])
      for (const auto& place : solid.subdomains.subdomains_of(i)) changed.push_back(place.subdomain);
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  schwarz_->renew(changed, nodal_blocks, fixed);
}

void TwoLevelPreconditioner::update(const IncrementalPotential& potential, const std::vector<Vec3>& u) {
  if (coarse_ && problem_.environment.contact.empty()) return;
  std::vector<Mat3> nodal_blocks = potential.nodal_blocks_with_contact();
  const SolidDiscretisation& solid = problem_.solid;
  if (solid.penalty || !solid.as_rigid.empty()) {
    build_coarse(potential, u, nodal_blocks);  // without these energies, which hardly resist rigid motions
    std::vector<double> diagonal(nodal_blocks.size(), 0);
    if (solid.penalty) solid.penalty->add_diagonal(solid.mls, diagonal);
    solid.as_rigid.add_diagonal(diagonal);
    for (std::size_t i = 0; i < nodal_blocks.size(); ++i) nodal_blocks[i] += diagonal[i] * Mat3::Identity();
  }
  parallel_invoke([&] { build_coarse(potential, u, nodal_blocks); }, [&] { update_schwarz(potential, nodal_blocks); });
  nodal_blocks_ = std::move(nodal_blocks);
}

void TwoLevelPreconditioner::apply(const ActiveIslands& active, const std::vector<Vec3>& r) {
  parallel_invoke([&] { coarse_->solve(r, active); }, [&] { schwarz_->solve(r, active.subdomains()); });
}

}  // namespace geo
