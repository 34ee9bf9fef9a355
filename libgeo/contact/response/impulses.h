// Impulses on the nodes that satisfy velocity constraints between surface points, with Coulomb
// friction (§ 3.3).
#pragma once

#include <span>
#include <vector>

#include "contact/response/contact_constraints.h"
#include "kerf/vec.h"

namespace geo {

/// Stencils of the constraints' points, in their order; see RelativeStencilBuilder for the
/// parameters.
std::vector<RelativeStencil> relative_stencils(const SurfaceWeights& weights,
                                               std::span<const ContactConstraint> constraints,
                                               const CoincidentVertices& stands_for,
                                               const std::vector<double>& inverse_mass);

/// Options of the solver.
struct ImpulseOptions {
  double friction = 0;      ///< Coulomb's coefficient
  int sweeps = 8;           ///< at most
  double tolerance = 1e-2;  ///< sweeps end when the largest change of a relative speed is this share of the largest
  /// Compliance: share of the effective inverse mass of point a alone that is added to that of the
  /// pair. It bounds impulses where both points share their nodes. Larger: softer contacts.
  double softness = 0.02;
};

/// Result of the solver.
struct ImpulseStats {
  std::size_t touching = 0;  ///< constraints with an impulse
  int sweeps = 0;
};

/// Changes `velocity`, per node, so that all constraints hold, by projected Gauss–Seidel in their
/// order. Normal impulses do not pull; friction impulses are at most `friction` times as large.
/// Impulses are equal and opposite, so momentum is conserved except at fixed nodes. Kinetic energy
/// does not grow unless points must separate.
ImpulseStats apply_impulses(const SurfaceWeights& weights, std::span<const ContactConstraint> constraints,
                            const CoincidentVertices& stands_for, const std::vector<double>& inverse_mass,
                            const ImpulseOptions& options, std::vector<Vec3>& velocity);

}  // namespace geo
