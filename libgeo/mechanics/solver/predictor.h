// Where Newton's method begins: an inertial predictor, and a line search back from it to the start
// of the step.
#pragma once

#include <vector>

#include "mechanics/solver/finite_rotation.h"
#include "mechanics/solver/incremental_potential.h"

namespace geo {

/// An iterate of Newton's method: displacements, with the potential and its derivatives there.
struct NewtonIterate {
  std::vector<Vec3> u;        ///< per node, model units
  std::vector<double> value;  ///< per island, the potential at u, J
  ElasticResponse response;   ///< at u
  std::vector<Vec3> force;    ///< per node, −gradient of the potential at u, N
};

/// The initial iterate, evaluated at all islands.
NewtonIterate predict(IncrementalPotential& potential, const FiniteRotation& rotation, ActiveIslands all);

}  // namespace geo
