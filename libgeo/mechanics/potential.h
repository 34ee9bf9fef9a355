// An energy of node displacements that acts besides elasticity: what contact brings into the implicit step.
#pragma once

#include <vector>

#include "base/vec.h"

namespace geo {

/// One value per node in all vectors. The curvature that block() and multiply() speak of is that at the displacements of the
/// last force() call, and never negative.
class Potential {
 public:
  virtual ~Potential() = default;
  /// J, at displacements u.
  virtual double energy(const std::vector<Vec3>& u) const = 0;
  /// Adds −∂E/∂u, N.
  virtual void force(const std::vector<Vec3>& u, std::vector<Vec3>& out) = 0;
  /// Adds the 3×3 diagonal blocks of ∂²E/∂u², N/m.
  virtual void blocks(std::vector<Mat3>& out) const = 0;
  /// Adds ∂²E/∂u² p.
  virtual void multiply(const std::vector<Vec3>& p, std::vector<Vec3>& out) const = 0;
};

}  // namespace geo
