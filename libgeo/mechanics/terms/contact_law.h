// Coulomb friction over a step: the derivative of a convex potential of the way slid since it began, smooth where that
// is less than `slow` (Li et al. 2020, § 5).
#pragma once

#include <algorithm>

namespace geo {

/// The potential, J. `most`: the largest force of friction, N, a coefficient times the normal force when the step
/// began; `slid` and `slow`: model units.
inline double friction_energy(double most, double slid, double slow) {
  return most * (slid < slow ? 0.5 * slid * slid / slow : slid - 0.5 * slow);
}

/// The force over the way slid, N/m: as stiff as the whole is taken to be, too.
inline double friction_drag(double most, double slid, double slow) { return most / std::max(slid, slow); }

}  // namespace geo
