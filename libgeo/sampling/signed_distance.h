// Signed distance to a closed surface on a grid (OpenVDB, hidden behind a pointer).
#pragma once

#include <memory>

#include "surface/triangle_mesh.h"

namespace geo {

/// Distances at voxels of the given size, negative inside, known everywhere inside. For depth, never for the last word
/// on inside: a slit thinner than a voxel is invisible to it.
class SignedDistance {
 public:
  SignedDistance(const TriangleMesh& solid, double voxel);
  ~SignedDistance();
  SignedDistance(const SignedDistance&) = delete;
  SignedDistance& operator=(const SignedDistance&) = delete;

  /// Trilinear; model units. Safe to call from several threads.
  double at(const Vec3& p) const;

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
};

}  // namespace geo
