// The law of contact of every potential that acts on nodes: a quadratic penalty on penetration,
// and lagged Coulomb friction with regularised slip.
//
// Penalty of stiffness k, N/m, on a penetration depth d(x) ≥ 0, model units (§ 3.3):
//   E = ½ k d²,  −∇E = k d n with n = −∇d,  ∇²E = k ∇²(½ d²), which is k n nᵀ behind a plane.
//
// Friction on the slip s, the relative displacement across n since the step began, with the bound
// b = μ N of a normal force N that is constant while energies are compared (Li et al. 2020,
// Incremental Potential Contact, § 5, with the Huber function for the smooth transition) and the
// slip regularisation ε, model units:
//   E = b |s|² / (2 ε) where |s| < ε, else b (|s| − ½ ε),
//   −∇E = −c s,  ∇²E ≼ c (I − n nᵀ),  c = b / max(|s|, ε), the secant stiffness.
// The secant Hessian is that of E where |s| < ε. Elsewhere it bounds that of E from above, which is
// less by c ŝ ŝᵀ, with ŝ = s / |s|.
//
// N is that of the step's beginning where the same contact balanced momentum then. A contact that
// is new in the step takes N from each Newton iterate but the first (docs/decisions/088).
#pragma once

#include <algorithm>
#include <cstdint>

#include "kerf/potential.h"

namespace geo {

/// Energy of the penalty, J: ½ k d², given d².
inline double penalty_energy(double stiffness, double squared_depth) { return 0.5 * stiffness * squared_depth; }

/// The same energy, J: ½ (k d) d, given the force. The two differ by rounding alone.
inline double penalty_work(double force, double depth) { return 0.5 * force * depth; }

/// Force of the penalty, N: k d n. `normal`: unit, out of what is penetrated.
inline Vec3 penalty_force(double stiffness, double depth, const Vec3& normal) { return stiffness * depth * normal; }

/// Hessian of the penalty, N/m, given the second derivative of ½ d².
inline Mat3 penalty_hessian(double stiffness, const Mat3& half_square_hessian) {
  return stiffness * half_square_hessian;
}

/// Hessian of the penalty behind a plane, N/m: k n nᵀ.
inline Mat3 plane_penalty_hessian(double stiffness, const Vec3& normal) {
  return stiffness * normal * normal.transpose();
}

/// Coulomb friction of one contact over a step.
struct LaggedFriction {
  double bound = 0;                ///< μ N, N
  double slip_regularisation = 0;  ///< ε, model units; positive where the bound is

  /// False where the contact does not press.
  bool acts() const { return bound > 0; }
  /// Energy, J. `slip`: |s|, model units.
  double energy(double slip) const { return bound * energy_over_bound(slip); }
  /// Energy over the bound, model units.
  double energy_over_bound(double slip) const {
    return slip < slip_regularisation ? 0.5 * slip * slip / slip_regularisation : slip - 0.5 * slip_regularisation;
  }
  /// c, N/m: the force over the slip.
  double secant_stiffness(double slip) const { return bound / std::max(slip, slip_regularisation); }
  /// Adds the force −c s and a Hessian between the true one and the secant, c (I − n nᵀ − θ ŝ ŝᵀ).
  /// θ = 1 − ½ |s − s'| / |s|, not less than 0, with s' the slip of Newton's last iterate: the true
  /// curvature where the slip has settled, the secant where it may turn back (docs/decisions/087).
  /// `slip`: s; `normal_projector`: n nᵀ; `last_slip`: s', zero in the first iterate.
  void add(const Vec3& slip, const Mat3& normal_projector, const Vec3& last_slip, Vec3& force, Mat3& hessian) const {
    const double length = slip.norm(), stiffness = secant_stiffness(length);
    force -= stiffness * slip;
    hessian += stiffness * (Mat3::Identity() - normal_projector);
    if (length > slip_regularisation && !last_slip.isZero(0)) {
      const double settled = std::max(0.0, 1 - 0.5 * (slip - last_slip).norm() / length);
      hessian -= settled * stiffness / (length * length) * slip * slip.transpose();
    }
  }
};

/// Whether a contact's normal force at the beginning of a substep is what balanced momentum there.
enum class NormalForce : std::uint8_t {
  balanced,  ///< it is: the same contact pressed in the step before
  estimated  ///< it is not: the contact is new, or one of others than before
};

/// The friction of one contact, as Newton's method remembers it.
struct FrictionMemory {
  double normal_force = 0;                             ///< N: that the bound is of
  Vec3 slip = Vec3::Zero(), last_slip = Vec3::Zero();  ///< of the present iterate and the one before
  NormalForce kind = NormalForce::estimated;
  bool has_iterate = false;  ///< of the substep

  /// Begins a substep with the normal force of that moment.
  void begin_substep(double normal, NormalForce of) {
    *this = {.normal_force = normal, .slip = Vec3::Zero(), .last_slip = Vec3::Zero(), .kind = of, .has_iterate = false};
  }
  /// Begins an iterate. Returns the change of the normal force that the bound is of, if that was
  /// estimated.
  double begin_iterate(const Vec3& new_slip, double normal) {
    last_slip = slip;
    slip = new_slip;
    const double change = has_iterate && kind == NormalForce::estimated ? normal - normal_force : 0;
    normal_force += change;
    has_iterate = true;
    return change;
  }
};

/// Effective inverse mass of a relative displacement, 1/kg: Σ w² / m. `inverse_mass`: per node, 0
/// for fixed nodes.
inline double effective_inverse_mass(Stencil stencil, const std::vector<double>& inverse_mass) {
  double sum = 0;
  for (const auto& e : stencil) sum += e.weight * e.weight * inverse_mass[e.node];
  return sum;
}

/// Friction of an explicit step, as an impulse over the slip velocity, kg: it stops the slip unless
/// that takes more than the bound. `bound`: μ times the normal impulse, N s; `speed`: of the slip;
/// `inverse_mass`: effective, positive.
inline double friction_impulse_factor(double bound, double speed, double inverse_mass) {
  return speed > bound * inverse_mass ? bound / speed : 1 / inverse_mass;
}

/// Changes the velocities of a stencil's nodes by an impulse along its relative displacement, N s.
inline void add_impulse(Stencil stencil, const Vec3& impulse, const std::vector<double>& inverse_mass,
                        std::vector<Vec3>& velocity) {
  for (const auto& e : stencil) velocity[e.node] += inverse_mass[e.node] * e.weight * impulse;
}

}  // namespace geo
