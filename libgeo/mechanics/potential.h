// An energy of node displacements that acts besides elasticity: what contact brings into a time step.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"

namespace geo {

/// One value per node in all vectors. The curvature that block() and multiply() speak of is that at the displacements of the
/// last force() call, and never negative.
class Potential {
 public:
  virtual ~Potential() = default;
  /// A part of the time step begins at displacements u: from and to in shares of the whole step, 0 to 1. A part that failed is
  /// begun again, shorter; one from 0 begins the step anew.
  virtual void begin(const std::vector<Vec3>&, double /*from*/, double /*to*/) {}
  /// Appends pairs of nodes: those that it makes depend on each other hang together by them. The same until the next begin().
  virtual void couple(std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) const = 0;
  /// Adds to sum[part[i]] the energy, J, at displacements u of what it does to node i; nodes that depend on each other are of one part.
  virtual void add_energy(const std::vector<Vec3>& u, std::span<const std::uint32_t> part, std::vector<double>& sum) const = 0;
  /// Of all nodes.
  double energy(const std::vector<Vec3>& u) const {
    std::vector<double> sum(1, 0);
    add_energy(u, std::vector<std::uint32_t>(u.size(), 0), sum);
    return sum[0];
  }
  /// Adds −∂E/∂u, N.
  virtual void force(const std::vector<Vec3>& u, std::vector<Vec3>& out) = 0;
  /// Adds the 3×3 diagonal blocks of ∂²E/∂u², N/m.
  virtual void blocks(std::vector<Mat3>& out) const = 0;
  /// Adds ∂²E/∂u² p.
  virtual void multiply(const std::vector<Vec3>& p, std::vector<Vec3>& out) const = 0;

  /// Of the explicit step, where nodes that are held have no inverse mass. No less than the largest eigenvalue of M⁻¹ ∂²E/∂u²,
  /// 1/s²; 0: it does not act there.
  virtual double stiffest(const std::vector<double>& /*inverse_mass*/) const { return 0; }
  /// Changes velocities by what it does in h seconds from displacements u on.
  virtual void impulse(const std::vector<Vec3>&, double /*h*/, const std::vector<double>& /*inverse_mass*/, std::vector<Vec3>& /*velocity*/) {}
};

}  // namespace geo
