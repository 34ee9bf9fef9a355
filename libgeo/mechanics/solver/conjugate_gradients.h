// Preconditioned conjugate gradients for Newton's direction, island by island: products in single
// precision, sums in double precision.
#pragma once

#include <vector>

#include "mechanics/solver/incremental_potential.h"
#include "mechanics/solver/two_level_preconditioner.h"

namespace geo {

/// When the iteration of an island ends.
struct CgStopping {
  bool first_direction;                 ///< of the time step: a stricter rule holds
  const std::vector<double>& moved;     ///< per island: distance since its stiffness was computed, in spacings
  const std::vector<double>& accuracy;  ///< per island, of displacements, in spacings
};

/// A Newton direction.
struct NewtonDirection {
  std::vector<Vec3> step;        ///< per node, model units
  std::vector<double> residual;  ///< per island: largest preconditioned residual, in spacings
};

/// Solves H step = force for the active islands; the entries of others stay. In the
/// first direction of a time step, an island of which the coarse level has most of r · M⁻¹ r moves
/// along the coarse correction alone at first, which counts as an iteration. An island ends
/// - when its preconditioned residual is less than half the accuracy, after one iteration at least;
///   in the first direction of a time step √(r · M⁻¹ r) must also have fallen to √0.3 ≈ 0.55 of its
///   initial value, or bodies would never quite come to rest;
/// - when √(r · M⁻¹ r) has fallen to √0.05 ≈ 0.22 of its initial value and the direction is so long
///   that Newton's method needs another one anyway;
/// - when rounding has made the curvature or the residual not positive; after 500 iterations.
///
/// Returns the number of iterations. Precondition: potential and preconditioner are linearised at
/// the same u.
int conjugate_gradients(IncrementalPotential& potential, TwoLevelPreconditioner& preconditioner,
                        const ActiveIslands& active, const std::vector<Vec3>& force, const CgStopping& stopping,
                        NewtonDirection& direction);

}  // namespace geo
