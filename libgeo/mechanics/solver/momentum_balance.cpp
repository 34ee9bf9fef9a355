// The equations of the centres by conjugate gradients, preconditioned by their 3×3 diagonal blocks:
// a stack has a few unknowns a body, and each product costs a pass over the contacts.
#include "mechanics/solver/momentum_balance.h"

#include <algorithm>
#include <cmath>

#include "kerf/parallel.h"
#include "mechanics/solver/fixed_nodes.h"

namespace geo {
namespace {

constexpr std::size_t terms_per_task = 64;  // smallest task worth a thread
// Error over the contact force, in accuracies: the coefficient of friction errs by as much in this
// step. At the default accuracy of 0.001 it is 0.005 (measured in docs/decisions/088).
constexpr double error_over_accuracy = 5;

}  // namespace

CentreWeights::CentreWeights(const IncrementalPotential& potential) {
  constexpr double rounding = 1e-12;  // of sums of weights, which are about one
  const PotentialSum& contact = potential.contact();
  const std::vector<std::uint32_t>& islands = potential.islands().free_of_nodes();
  std::vector<std::vector<Weight>> sums(contact.size());
  parallel_for(sums.size(), terms_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      std::vector<Weight>& own = sums[t];
      for (const NodeWeight& e : contact.stencil(t)) {
        const auto f = islands[e.node];
        const auto known = std::find_if(own.begin(), own.end(), [&](const Weight& sum) { return sum.first == f; });
        if (known == own.end())
          own.emplace_back(f, e.weight);
        else
          known->second += e.weight;
      }
      std::erase_if(own, [](const Weight& sum) { return std::abs(sum.second) < rounding; });
    }
  });
  for (const std::vector<Weight>& own : sums) {
    first_.push_back(weights_.size());
    weights_.insert(weights_.end(), own.begin(), own.end());
  }
  first_.push_back(weights_.size());
}

MomentumBalance::MomentumBalance(const IncrementalPotential& potential, const CentreWeights& centres,
                                 const ActiveIslands& active, const std::vector<Vec3>& u)
    : potential_(potential),
      centres_(centres),
      islands_(potential.islands()),
      u_(u),
      mass_(islands_.free_count(), 0),
      moves_(islands_.free_count(), 0),
      island_(islands_.free_count(), 0),
      residual_(islands_.free_count(), Vec3::Zero()) {
  const StepProblem& problem = potential.problem();
  std::vector<char> held(islands_.free_count(), 0);
  for (std::size_t i = 0; i < problem.solid.size(); ++i) {
    const auto f = islands_.free_of_nodes()[i];
    mass_[f] += problem.solid.mass[i];
    island_[f] = islands_.of(i);
    if (is_fixed(problem.environment, i) || !active[islands_.of(i)]) held[f] = 1;
    if (potential.is_touched(i)) moves_[f] = 1;
  }
  for (std::size_t f = 0; f < held.size(); ++f)
    if (held[f]) moves_[f] = 0;
}

void MomentumBalance::correct(std::vector<Vec3>& direction) {
  if (std::find(moves_.begin(), moves_.end(), 1) == moves_.end()) return;
  add_inertia_and_loads(direction);
  add_contact(direction);
  const std::vector<Vec3> translation = solved();
  for (std::size_t i = 0; i < direction.size(); ++i)
    if (const auto f = islands_.free_of_nodes()[i]; moves_[f]) direction[i] += translation[f];
}

void MomentumBalance::mark_unbalanced(const std::vector<Vec3>& direction, int iterate,
                                      const std::vector<double>& accuracy, std::vector<char>& unbalanced) const {
  const double tolerance = error_over_accuracy * potential_.problem().accuracy;
  // Contacts between bodies are others in each step. Their first normal force is an estimate, which
  // is good enough for steps that are less accurate than the default.
  const int least_iterates = potential_.problem().accuracy > 1e-3 ? 1 : 3;
  std::vector<Vec3> promised(terms_.size()), found(terms_.size());
  parallel_for(terms_.size(), terms_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const PotentialSum::LinearisedTerm& term = terms_[k].term;
      const Vec3 from = weighted_sum(term.stencil, u_), moved = weighted_sum(term.stencil, direction);
      promised[k] = term.force - term.hessian * moved;
      found[k] = term.potential->derivatives(term.index, from + moved).force;
    }
  });
  std::vector<Vec3> missing(mass_.size(), Vec3::Zero());
  std::vector<double> size(mass_.size(), 0);
  for (std::size_t k = 0; k < terms_.size(); ++k)
    for (const auto& [f, weight] : terms_[k].weight) {
      missing[f] += weight * (found[k] - promised[k]);
      size[f] += std::abs(weight) * promised[k].norm();
      const bool is_estimated = !terms_[k].term.potential->within_components() && iterate < least_iterates;
      if (is_estimated && !promised[k].isZero(0)) unbalanced[island_[f]] = 1;
    }
  for (std::size_t f = 0; f < missing.size(); ++f) {
    const double of_accuracy =
        error_over_accuracy * accuracy[island_[f]] * mass_[f] / potential_.squared_time(island_[f]);
    if (missing[f].norm() > std::max(tolerance * size[f], of_accuracy)) unbalanced[island_[f]] = 1;
  }
}

void MomentumBalance::add_inertia_and_loads(const std::vector<Vec3>& direction) {
  const StepProblem& problem = potential_.problem();
  for (std::size_t i = 0; i < direction.size(); ++i)
    if (const auto f = islands_.free_of_nodes()[i]; moves_[f])
      residual_[f] += potential_.load()[i] - problem.solid.mass[i] * (1 / potential_.squared_time(island_[f])) *
                                                 (u_[i] + direction[i] - potential_.inertial_target()[i]);
}

// The second derivative of a term at the iterate, by differences of its force over a length that is
// far below any slip regularisation. The solver's Hessian bounds that of friction from above, so a
// body that begins to slide would take many directions to reach its speed.
Mat3 MomentumBalance::curvature(const PotentialSum::LinearisedTerm& term, const Vec3& at) const {
  const double step = 1e-7 * potential_.problem().solid.spacing[term.stencil[0].node];
  const Vec3 force = term.potential->derivatives(term.index, at).force;
  Mat3 hessian;
  for (int c = 0; c < 3; ++c)
    hessian.col(c) = (force - term.potential->derivatives(term.index, at + step * Vec3::Unit(c)).force) / step;
  return 0.5 * (hessian + hessian.transpose());
}

void MomentumBalance::add_contact(const std::vector<Vec3>& direction) {
  const std::vector<PotentialSum::LinearisedTerm> all = potential_.contact().linearised_terms();
  std::vector<CentreTerm> centres(all.size());
  std::vector<Vec3> force(all.size());
  parallel_for(all.size(), terms_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      for (const CentreWeights::Weight& weight : centres_.of(all[k].id))
        if (moves_[weight.first]) centres[k].weight.push_back(weight);
      if (centres[k].weight.empty()) continue;
      centres[k].term = all[k];
      Mat3& hessian = centres[k].term.hessian;
      if (all[k].potential->within_components() && !hessian.isZero(0))
        hessian = curvature(all[k], weighted_sum(all[k].stencil, u_));
      force[k] = all[k].force - hessian * weighted_sum(all[k].stencil, direction);
    }
  });
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (centres[k].weight.empty()) continue;
    for (const auto& [f, weight] : centres[k].weight) residual_[f] += weight * force[k];
    terms_.push_back(std::move(centres[k]));
  }
}

std::vector<Vec3> MomentumBalance::product(const std::vector<Vec3>& p) const {
  std::vector<Vec3> result(p.size(), Vec3::Zero());
  for (std::size_t f = 0; f < p.size(); ++f)
    if (moves_[f]) result[f] = mass_[f] / potential_.squared_time(island_[f]) * p[f];
  for (const CentreTerm& centre : terms_) {
    Vec3 relative = Vec3::Zero();
    for (const auto& [f, weight] : centre.weight) relative += weight * p[f];
    relative = (centre.term.hessian * relative).eval();
    for (const auto& [f, weight] : centre.weight) result[f] += weight * relative;
  }
  return result;
}

// The inverses of the diagonal blocks.
std::vector<Mat3> MomentumBalance::inverse_blocks() const {
  std::vector<Mat3> block(mass_.size(), Mat3::Identity());
  for (std::size_t f = 0; f < block.size(); ++f)
    block[f] *= moves_[f] ? mass_[f] / potential_.squared_time(island_[f]) : 1;
  for (const CentreTerm& centre : terms_)
    for (const auto& [f, weight] : centre.weight) block[f] += weight * weight * centre.term.hessian;
  for (Mat3& b : block) b = b.inverse().eval();
  return block;
}

// The translation of each free-floating island.
std::vector<Vec3> MomentumBalance::solved() const {
  constexpr double reduction = 1e-12;  // of the squared residual: far below what friction may err by
  constexpr int max_iterations = 100;
  const std::vector<Mat3> inverse = inverse_blocks();
  const std::size_t n = mass_.size();
  std::vector<Vec3> x(n, Vec3::Zero()), r = residual_, z(n, Vec3::Zero()), p = z;
  double before = 0, first = 0;
  for (int k = 0; k < max_iterations; ++k) {
    double rz = 0;
    for (std::size_t f = 0; f < n; ++f) {
      z[f] = inverse[f] * r[f];
      rz += r[f].dot(z[f]);
    }
    if (k == 0) first = rz;
    if (!(rz > reduction * first)) break;
    for (std::size_t f = 0; f < n; ++f) p[f] = z[f] + (k == 0 ? 0 : rz / before) * p[f];
    const std::vector<Vec3> hp = product(p);
    double curvature = 0;
    for (std::size_t f = 0; f < n; ++f) curvature += p[f].dot(hp[f]);
    if (!(curvature > 0)) break;
    const double step = rz / curvature;
    for (std::size_t f = 0; f < n; ++f) {
      x[f] += step * p[f];
      r[f] -= step * hp[f];
    }
    before = rz;
  }
  return x;
}

}  // namespace geo
