// Velocity constraints between places of surfaces, and the impulses on nodes that keep them (§ 3.3).
#pragma once

#include <span>
#include <vector>

#include "contact/response/relative_stencil.h"
#include "kerf/vec.h"

namespace geo {

/// Two places that may not come closer along a normal.
struct ContactConstraint {
  SurfacePoint a, b;
  Vec3 normal;       ///< unit; from b to a
  double depth = 0;  ///< how far past each other the motion would bring them, model units
  double approach =
      0;  ///< relative velocity along −normal that is still allowed, model units per second; negative: they must part
};

/// Their rows (relative_row.h), in the order given. `stands_for`: which surface vertices carry one vertex of the places
/// (together, they move as their average). Made by all threads.
std::vector<RelativeStencil> relative_stencils(const SurfaceWeights& weights,
                                               std::span<const ContactConstraint> touching, const Copies& stands_for,
                                               const std::vector<double>& inverse_mass);

struct ImpulseStats {
  std::size_t touching = 0;  ///< constraints with an impulse
  int sweeps = 0;
};

/// Changes the velocities of nodes as little as possible (in the kinetic energy's norm) so that no two places approach
/// each other, by impulses along the normals that are spread over the nodes by the weights, and by friction at most
/// `friction` times as large. Pairs of equal and opposite impulses: momentum is what it was, but for nodes of infinite
/// mass (inverse mass 0). Kinetic energy does not grow unless they must part. `stands_for` as in relative_stencils().
/// Projected Gauss-Seidel, in the order given.
struct ImpulseOptions {
  double friction = 0;
  int sweeps = 8;           ///< at most
  double tolerance = 1e-2;  ///< they end when the largest change of a relative velocity is this share of the largest
  double softness =
      0.02;  ///< share of the places' own mobility that is added to the pair's: for places that share their nodes
};
ImpulseStats apply_impulses(const SurfaceWeights& weights, std::span<const ContactConstraint> touching,
                            const Copies& stands_for, const std::vector<double>& inverse_mass,
                            const ImpulseOptions& options, std::vector<Vec3>& velocity);

}  // namespace geo
