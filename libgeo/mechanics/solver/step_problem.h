// One time step by backward Euler, as the incremental potential and the solver receive it.
#pragma once

#include <algorithm>
#include <cstddef>

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

  /// |v|² over the square of the spacing at a node.
  double squared_in_spacings(const Vec3& v, std::size_t node) const {
    return v.squaredNorm() / (solid.spacing[node] * solid.spacing[node]);
  }
  /// Tolerance of |d| (|d| + moved), in squared spacings, an estimate of the error that a direction
  /// d leaves: the Newton error grows with |d|², and with |d| times the distance moved since the
  /// stiffness was computed. At most 0.01, as the estimate holds for small directions only.
  double quadratic_tolerance() const { return std::min(accuracy, 0.01); }
};

}  // namespace geo
