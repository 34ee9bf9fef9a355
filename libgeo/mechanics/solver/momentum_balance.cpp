// The equations of the centres by conjugate gradients, preconditioned by their 3×3 diagonal blocks:
// a stack has a few unknowns a body, and each product costs a pass over the contacts.
#include "mechanics/solver/momentum_balance.h"

#include <utility>

#include "mechanics/solver/fixed_nodes.h"

namespace geo {
namespace {

// A contact term as the centres of the free-floating islands see it.
struct CentreTerm {
  std::vector<std::pair<std::uint32_t, double>> weight;  // free-floating island, sum of the weights there
  Mat3 hessian;
};

class MomentumBalance {
 public:
  MomentumBalance(const IncrementalPotential& potential, const ActiveIslands& active)
      : potential_(potential),
        islands_(potential.islands()),
        mass_(islands_.free_count(), 0),
        moves_(islands_.free_count(), 0),
        residual_(islands_.free_count(), Vec3::Zero()) {
    const StepProblem& problem = potential.problem();
    std::vector<char> held(islands_.free_count(), 0);
    for (std::size_t i = 0; i < problem.solid.size(); ++i) {
      const auto f = islands_.free_of_nodes()[i];
      mass_[f] += problem.solid.mass[i];
      if (is_fixed(problem.environment, i) || !active[islands_.of(i)]) held[f] = 1;
      if (potential.is_touched(i)) moves_[f] = 1;
    }
    for (std::size_t f = 0; f < held.size(); ++f) moves_[f] = moves_[f] && !held[f], any_ = any_ || moves_[f];
  }

  void correct(const std::vector<Vec3>& u, std::vector<Vec3>& direction) {
    if (!any_) return;
    add_inertia_and_loads(u, direction);
    add_contact(direction);
    const std::vector<Vec3> translation = solved();
    for (std::size_t i = 0; i < direction.size(); ++i)
      if (const auto f = islands_.free_of_nodes()[i]; moves_[f]) direction[i] += translation[f];
  }

 private:
  void add_inertia_and_loads(const std::vector<Vec3>& u, const std::vector<Vec3>& direction) {
    const StepProblem& problem = potential_.problem();
    const double per_mass = 1 / (problem.dt * problem.dt);
    for (std::size_t i = 0; i < direction.size(); ++i)
      if (const auto f = islands_.free_of_nodes()[i]; moves_[f])
        residual_[f] += potential_.load()[i] - problem.solid.mass[i] * per_mass *
                                                   (u[i] + direction[i] - potential_.inertial_target()[i]);
  }

  void add_contact(const std::vector<Vec3>& direction) {
    for (const PotentialSum::ActiveTerm& term : potential_.contact().active_terms()) {
      CentreTerm centre{{}, term.hessian};
      for (const NodeWeight& e : term.stencil) {
        const auto f = islands_.free_of_nodes()[e.node];
        if (!moves_[f]) continue;
        auto known = centre.weight.begin();
        while (known != centre.weight.end() && known->first != f) ++known;
        if (known == centre.weight.end())
          centre.weight.emplace_back(f, e.weight);
        else
          known->second += e.weight;
      }
      // Both points of a contact within one island sum to zero, up to rounding.
      std::erase_if(centre.weight, [](const auto& w) { return std::abs(w.second) < 1e-12; });
      if (centre.weight.empty()) continue;
      const Vec3 force = term.force - term.hessian * weighted_sum(term.stencil, direction);
      for (const auto& [f, weight] : centre.weight) residual_[f] += weight * force;
      terms_.push_back(std::move(centre));
    }
  }

  std::vector<Vec3> product(const std::vector<Vec3>& p) const {
    const double dt = potential_.problem().dt;
    std::vector<Vec3> result(p.size(), Vec3::Zero());
    for (std::size_t f = 0; f < p.size(); ++f)
      if (moves_[f]) result[f] = mass_[f] / (dt * dt) * p[f];
    for (const CentreTerm& term : terms_) {
      Vec3 relative = Vec3::Zero();
      for (const auto& [f, weight] : term.weight) relative += weight * p[f];
      relative = term.hessian * relative;
      for (const auto& [f, weight] : term.weight) result[f] += weight * relative;
    }
    return result;
  }

  // The inverses of the diagonal blocks.
  std::vector<Mat3> inverse_blocks() const {
    const double dt = potential_.problem().dt;
    std::vector<Mat3> block(mass_.size(), Mat3::Identity());
    for (std::size_t f = 0; f < block.size(); ++f) block[f] *= moves_[f] ? mass_[f] / (dt * dt) : 1;
    for (const CentreTerm& term : terms_)
      for (const auto& [f, weight] : term.weight) block[f] += weight * weight * term.hessian;
    for (Mat3& b : block) b = b.inverse().eval();
    return block;
  }

  std::vector<Vec3> solved() const {
    // Far below what friction may differ by: a thousandth of the residual's effect, squared.
    constexpr double reduction = 1e-12;
    constexpr int most_iterations = 100;
    const std::vector<Mat3> inverse = inverse_blocks();
    const std::size_t n = mass_.size();
    std::vector<Vec3> x(n, Vec3::Zero()), r = residual_, z(n), p(n, Vec3::Zero());
    double before = 0, first = 0;
    for (int k = 0; k < most_iterations; ++k) {
      double rz = 0;
      for (std::size_t f = 0; f < n; ++f) z[f] = inverse[f] * r[f], rz += r[f].dot(z[f]);
      if (k == 0) first = rz;
      if (!(rz > reduction * first)) break;
      for (std::size_t f = 0; f < n; ++f) p[f] = z[f] + (k == 0 ? 0 : rz / before) * p[f];
      const std::vector<Vec3> hp = product(p);
      double curvature = 0;
      for (std::size_t f = 0; f < n; ++f) curvature += p[f].dot(hp[f]);
      if (!(curvature > 0)) break;
      for (std::size_t f = 0; f < n; ++f) x[f] += rz / curvature * p[f], r[f] -= rz / curvature * hp[f];
      before = rz;
    }
    return x;
  }

  const IncrementalPotential& potential_;
  const Islands& islands_;
  std::vector<double> mass_;    // per free-floating island
  std::vector<char> moves_;     // per free-floating island: touched, and nothing clamps it
  std::vector<Vec3> residual_;  // per free-floating island, N
  std::vector<CentreTerm> terms_;
  bool any_ = false;
};

}  // namespace

void balance_momentum(const IncrementalPotential& potential, const ActiveIslands& active, const std::vector<Vec3>& u,
                      std::vector<Vec3>& direction) {
  MomentumBalance(potential, active).correct(u, direction);
}

}  // namespace geo
