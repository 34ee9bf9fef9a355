// One implicit time step, as the incremental potential and the solver receive it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "kerf/solid.h"
#include "mechanics/solver/solid_discretisation.h"

namespace geo {

/// The step of dt seconds from `start` on. Refers to everything.
struct StepProblem {
  const SolidDiscretisation& solid;
  const State& start;              ///< at the beginning of the step
  double dt;                       ///< s
  const Environment& environment;  ///< its contact potentials have begun at start.displacement
  double accuracy;                 ///< of displacements, relative to the spacing of nodes
  /// Per node: 1 where State::acceleration is to be gone on from. Islands of such nodes alone make
  /// Bossak's step, others backward Euler's. Empty: all others.
  std::span<const std::uint8_t> smooth = {};

  /// |v|² over the square of the spacing at a node.
  double squared_in_spacings(const Vec3& v, std::size_t node) const {
    return v.squaredNorm() / (solid.spacing[node] * solid.spacing[node]);
  }
  /// The accuracy, in spacings, where contact acts on nodes with spacings up to `spacing`; 0: on
  /// none. An error e of displacements is one of e / Δt² of accelerations, which friction is to
  /// stand out from: at the default accuracy of 0.001 at most a hundredth of gravity
  /// (docs/decisions/088).
  double accuracy_in_contact(double spacing) const {
    constexpr double acceleration_per_accuracy = 10;  // in gravities: 0.01 / 0.001
    const double fall = acceleration_per_accuracy * dt * dt * environment.gravity.norm();
    return fall > 0 && fall < spacing ? accuracy * fall / spacing : accuracy;
  }
  /// The accuracy, in spacings, of an island whose nodes forces have moved by up to `correction`
  /// spacings from where inertia or the prediction took them. It is that of contact, where that
  /// correction is less than the fall which accuracy_in_contact() refers to; else it refers to the
  /// correction instead, of which backward Euler's error in a time step is about half. Beyond a
  /// tenth of a spacing it is coarser still, up to a hundredth of a spacing (docs/decisions/065,
  /// 087, 105). `touched`: accuracy_in_contact().
  double accuracy_after(double touched, double correction) const {
    constexpr double unit_correction = 0.1, loose_accuracy = 0.01;
    const double relative = std::max(accuracy, touched / unit_correction) * correction;
    return std::max(touched, std::min(relative, loose_accuracy));
  }
  /// Tolerance of |d| (|d| + moved), in squared spacings, an estimate of the error that a direction
  /// d leaves: the Newton error grows with |d|², and with |d| times the distance moved since the
  /// stiffness was computed. At most 0.01, as the estimate holds for small directions only.
  /// `accuracy`: of the island.
  static double quadratic_tolerance(double accuracy) { return std::min(accuracy, 0.01); }
};

}  // namespace geo
