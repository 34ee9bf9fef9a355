// Displacement gradients at the points of blocks, and the transposed operation: nodal forces from
// stresses. In double precision, or faster in single precision.
#pragma once

#include <vector>

#include "mechanics/discretisation/material_points.h"
#include "mechanics/discretisation/point_lanes.h"

namespace geo {

/// The loose variant uses the 16-bit shape gradients of stiffness products and single precision:
/// half the memory traffic, four points side by side. A block's affine motion at the start is then
/// kept in double precision, and only the displacement relative to it is rounded. So rotations
/// cause no spurious strain, and a relative strain has an error of at most some ten-thousandths of
/// itself. Energies stay consistent with forces.
class BlockStrain {
 public:
  /// Memory of one thread, reused from block to block.
  struct Scratch {
    std::vector<double> values;
    std::vector<float> single;
  };
  /// Double precision.
  explicit BlockStrain(const MaterialPoints& points);
  /// Loose, relative to each block's affine motion at the displacements `start`. `position`: nodes
  /// at rest, kept by reference. `component`: per node, its component of the visibility graph.
  /// Blocks with nodes of several components, or with points of poor quality, use double precision.
  BlockStrain(const MaterialPoints& points, const std::vector<Vec3>& position,
              const std::vector<std::uint32_t>& component, const std::vector<Vec3>& start);

  /// The points, by reference.
  const MaterialPoints& points() const { return points_; }
  /// ∇u at the points of a block, in order; padding is zero.
  void gradients(std::size_t block, const std::vector<Vec3>& u, Scratch& scratch, PointMatrices<double>& out) const;
  /// Σ stress · shape gradient: four numbers per node of the block.
  void nodal_forces(std::size_t block, const PointMatrices<double>& stress, Scratch& scratch, double* out) const;

 private:
  struct AffineMotion {
    Mat3 gradient;
    bool known = false;
  };
  bool is_loose(std::size_t block) const { return !motion_.empty() && motion_[block].known; }

  const MaterialPoints& points_;
  const std::vector<Vec3>* position_ = nullptr;
  std::vector<AffineMotion> motion_;  // per block; known if the block is loose
};

}  // namespace geo
