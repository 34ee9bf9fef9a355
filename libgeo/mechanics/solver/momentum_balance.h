// Momentum of what is touched: the translation that a Newton direction lacks.
//
// Conjugate gradients stop at an accuracy of displacements. In a time step an error e of the
// whole body's displacement is an error e / τ² of its acceleration, which may be as large as
// friction. Internal forces move no centre of mass, so the few equations of the centres can be
// solved exactly.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "mechanics/solver/incremental_potential.h"

namespace geo {

/// The contact terms of a time step as the centres of the free-floating islands see them.
class CentreWeights {
 public:
  /// The sum of a stencil's weights in a free-floating island.
  using Weight = std::pair<std::uint32_t, double>;
  /// Sums the weights of all terms.
  explicit CentreWeights(const IncrementalPotential& potential);
  /// Those of a term. Both points of a contact within one island sum to zero, up to rounding, and
  /// are left out.
  std::span<const Weight> of(std::uint32_t term) const {
    return {weights_.data() + first_[term], first_[term + 1] - first_[term]};
  }

 private:
  std::vector<Weight> weights_;
  std::vector<std::size_t> first_;  // per term, and one more
};

/// Forces, inertia and contact of the free-floating islands that contact touches and nothing
/// clamps, along one Newton direction.
class MomentumBalance {
 public:
  /// At the iterate u, after its force(). `active`: islands that the direction moves. Refers to
  /// all of them.
  MomentumBalance(const IncrementalPotential& potential, const CentreWeights& centres, const ActiveIslands& active,
                  const std::vector<Vec3>& u);

  /// Adds to the direction the translation of each of these islands that it lacks, to first order:
  /// Σ_g (M_f/τ² δ_fg + Σ_k W_kf W_kg H_k) t_g = R_f, with M_f its mass, R_f the residual of its
  /// nodes' sum without internal forces, H_k the Hessians of contact and W_kf the sum of the
  /// weights of stencil k in island f.
  void correct(std::vector<Vec3>& direction);
  /// Sets unbalanced[island] to 1 where the force of contact on a free-floating island, at the end
  /// of the direction, is not the one that its linearisation promised: what sticks begins to slide,
  /// or a contact opens. Also where bodies touch each other in one of the first iterates, which
  /// know their normal forces by an estimate only. `iterate`: from 1. `accuracy`: per island, of
  /// displacements where forces are larger than weight, beyond that of contact, model units: what
  /// moves an island by a few of it is no lack of balance (docs/decisions/108).
  void mark_unbalanced(const std::vector<Vec3>& direction, int iterate, const std::vector<double>& accuracy,
                       std::vector<char>& unbalanced) const;

 private:
  // A contact term as the centres of the free-floating islands see it.
  struct CentreTerm {
    std::vector<CentreWeights::Weight> weight;  // of those that move
    PotentialSum::LinearisedTerm term;          // with the true curvature
  };
  Mat3 curvature(const PotentialSum::LinearisedTerm& term, const Vec3& at) const;
  void add_inertia_and_loads(const std::vector<Vec3>& direction);
  void add_contact(const std::vector<Vec3>& direction);
  std::vector<Vec3> product(const std::vector<Vec3>& p) const;
  std::vector<Mat3> inverse_blocks() const;
  std::vector<Vec3> solved() const;

  const IncrementalPotential& potential_;
  const CentreWeights& centres_;
  const Islands& islands_;
  const std::vector<Vec3>& u_;
  std::vector<double> mass_;           // per free-floating island
  std::vector<char> moves_;            // per free-floating island: touched, and nothing clamps it
  std::vector<std::uint32_t> island_;  // per free-floating island: the island that it is part of
  std::vector<Vec3> residual_;         // per free-floating island, N
  std::vector<CentreTerm> terms_;
};

}  // namespace geo
