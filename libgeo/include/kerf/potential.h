// Interface of an energy that acts on nodes in addition to elasticity: contact, friction,
// penalties.
//
// Each of its terms depends on one relative displacement d = Σ w_i u_i, as in
// incremental potential contact (Li et al. 2020). The nodes i and weights w_i of a term are its
// contact stencil, one row of the contact Jacobian.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// A node of a stencil and its weight.
struct NodeWeight {
  std::uint32_t node;
  double weight;
};

/// One row of a sparse Jacobian over the nodes, no node twice. Its relative displacement is
/// Σ weight × u[node].
using Stencil = std::span<const NodeWeight>;

/// Σ |weight|: the largest norm of weighted_sum() if no value is longer than 1.
inline double weight_norm(Stencil stencil) {
  double sum = 0;
  for (const auto& e : stencil) sum += std::abs(e.weight);
  return sum;
}

/// Σ weight × values[node]. With displacements as values, it is the stencil's relative
/// displacement.
inline Vec3 weighted_sum(Stencil stencil, const std::vector<Vec3>& values) {
  Vec3 sum = Vec3::Zero();
  for (const auto& e : stencil) sum += e.weight * values[e.node];
  return sum;
}

/// A sum of energy terms E_k(d_k), d_k the relative displacement of the k-th stencil, model units.
/// All vectors have one value per node.
class Potential {
 public:
  virtual ~Potential() = default;

  /// Begins a substep at displacements u. `from` and `to` are fractions of the whole time step. A
  /// substep that failed begins again with a smaller `to`; `from` = 0 restarts the time step.
  virtual void begin_substep(const std::vector<Vec3>& /*u*/, double /*from*/, double /*to*/) {}
  /// The number of stencils. Stencils stay the same, at the same addresses, until the next
  /// begin_substep().
  virtual std::size_t size() const = 0;
  /// The k-th stencil. An empty one has no effect.
  virtual Stencil stencil(std::size_t k) const = 0;
  /// True if forces change smoothly with the motion and with time, as those of springs and pressure
  /// do and those of contact do not. Then steps of second order go on (ImplicitScheme::bossak).
  virtual bool is_smooth() const { return false; }
  /// True if no stencil couples two components of the visibility graph.
  virtual bool within_components() const { return false; }
  /// The k-th term is zero while no node has moved farther than this, model units, from where it
  /// was at begin_substep(). 0: the term may be active there already.
  virtual double activation_distance(std::size_t /*k*/) const { return 0; }
  /// E_k at relative displacement d, J.
  virtual double energy(std::size_t k, const Vec3& d) const = 0;

  /// First and second derivative of a term.
  struct Derivatives {
    Vec3 force = Vec3::Zero();    ///< −∂E/∂d, N; each node gets it times its weight
    Mat3 hessian = Mat3::Zero();  ///< ∂²E/∂d², N/m, or an upper bound; positive semidefinite
  };
  /// The derivatives of E_k at relative displacement d.
  virtual Derivatives derivatives(std::size_t k, const Vec3& d) const = 0;

  /// Begins a Newton iterate in which the k-th term has relative displacement d. Takes the bound of
  /// its friction from its normal force there, except in the first iterate of a substep. Returns
  /// the change of energy(k, d) by that, J. Several threads may call this, for different k.
  virtual double begin_iterate(std::size_t /*k*/, const Vec3& /*d*/) { return 0; }

  /// An upper bound of the k-th Hessian's eigenvalues, N/m. 0: explicit steps ignore the term.
  virtual double stiffness_bound(std::size_t /*k*/) const { return 0; }
  /// An upper bound of the largest eigenvalue of M⁻¹ ∂²E/∂u², 1/s², from stiffness_bound(): the
  /// largest absolute row sum of M⁻¹ Σ k w wᵀ. Fixed nodes have an inverse mass of 0.
  double eigenvalue_bound(const std::vector<double>& inverse_mass) const;
  /// Adds the velocity change of an explicit substep of h seconds, from displacements u.
  virtual void apply_impulse(const std::vector<Vec3>& /*u*/, double /*h*/, const std::vector<double>& /*inverse_mass*/,
                             std::vector<Vec3>& /*velocity*/) {}
};

}  // namespace geo
