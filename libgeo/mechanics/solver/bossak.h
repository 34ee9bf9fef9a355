// Bossak's scheme for one node (Wood, Bossak and Zienkiewicz 1980), in the member of its family
// whose acceleration is the mean one of the step.
//
// The family has Newmark's formulas and a balance in which the last acceleration takes part:
//   (1 − α) a₁ + α a₀ = A,  u₁ = u₀ + Δt v₀ + Δt² ((½ − β) a₀ + β a₁),
//   v₁ = v₀ + Δt ((1 − γ) a₀ + γ a₁),  with A the force at u₁ over the mass.
// It is of second order with γ = ½ − α, and stable at all frequencies with β = ¼ (1 − α)². A step
// leaves the share ρ = (1 + α) / (1 − α) of the highest frequencies. For α = −½ it is a third, and
// γ is 1, so that a₁ is (v₁ − v₀) / Δt: the acceleration that a state has anyway. Then β = 9/16,
// a₁ = (2 A + a₀) / 3, and u₁ = u₀ + Δt v₀ + Δt² (a₀ / 8 + 3 A / 8).
#pragma once

#include "kerf/vec.h"

namespace geo {

/// A step of Bossak's scheme, α = −½. Drag acts on velocities, by half before the step and by half
/// after it (Strang 1968), so that its order is the second, too.
struct Bossak {
  static constexpr double inertial_share = 3.0 / 8;  ///< τ² / Δt²: what a constant A adds to u₁, over Δt² A
  static constexpr double memory_share = 1.0 / 8;    ///< the same of a₀

  /// Accuracy of a step over that of backward Euler's. A step errs in the same sense as the one
  /// before it: towards the prediction. At the default accuracy a bar on a hinge lost, or
  /// gained, more by that in ten seconds than the scheme damps (docs/decisions/120).
  static constexpr double accuracy_share = 1e-3;

  double dt;                                  ///< s
  double drag;                                ///< Material::damping, 1/s
  Vec3 displacement, velocity, acceleration;  ///< u₀, v₀, a₀

  /// The factor of velocities in half a step: 1 / (1 + x + x²/2) with x = ½ Δt drag, which is
  /// exp(−x) to second order.
  double slowed() const {
    const double x = 0.5 * dt * drag;
    return 1 / (1 + x + 0.5 * x * x);
  }
  /// ũ: where the node gets without a force.
  Vec3 target() const { return displacement + dt * slowed() * velocity + memory_share * dt * dt * acceleration; }
  /// a₁ of a step that ended at displacement u.
  Vec3 acceleration_after(const Vec3& u) const {
    return (2 / (inertial_share * dt * dt) * (u - target()) + acceleration) / 3;
  }
  /// v₁ of a step that ended with acceleration a.
  Vec3 velocity_after(const Vec3& a) const { return slowed() * (slowed() * velocity + dt * a); }
};

}  // namespace geo
