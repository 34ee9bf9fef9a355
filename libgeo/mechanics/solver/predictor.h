// Where Newton's method begins: the inertial prediction with affine accelerations of the last step.
// A search leads back from it, along the line to the start of the step, or to a finite rotation.
#pragma once

#include <vector>

#include "mechanics/solver/finite_rotation.h"
#include "mechanics/solver/incremental_potential.h"

namespace geo {

/// An iterate of Newton's method: displacements, with the potential and its derivatives there.
struct NewtonIterate {
  std::vector<Vec3> u;        ///< per node, model units
  std::vector<double> value;  ///< per island, the potential at u, J
  ElasticResponse response;   ///< elastic forces and strains at u, for force() and linearise()
  std::vector<Vec3> force;    ///< per node, −gradient of the potential at u, N
};

/// The initial iterate of a step, evaluated at all islands: the prediction, then the search back
/// from it (predictor.cpp). `rotation`: finite rotations, which compete with the straight
/// prediction. `all`: every island is selected; passed by value, as the function changes the
/// selection.
NewtonIterate predict(IncrementalPotential& potential, const FiniteRotation& rotation, ActiveIslands all);

}  // namespace geo
