// ∇u at the points of blocks, and what their stresses pull nodes by.
#pragma once

#include <vector>

#include "mechanics/discretisation/material_points.h"
#include "mechanics/discretisation/point_lanes.h"

namespace geo {

/// In double precision; or, to a loose accuracy, in single precision from the 16 bits that products take, with half the
/// memory to read and four points side by side. Then blocks have in double the affine motion that they had at first,
/// and the rest is about that: what has turned has no strain from rounding, and a strain about it is off by some
/// ten-thousandths of itself, at most. Energies are still those of the forces.
class BlockStrain {
 public:
  /// Of one thread, used block after block.
  struct Room {
    std::vector<double> values;
    std::vector<float> few;
  };
  /// In double precision.
  explicit BlockStrain(const MaterialPoints& points);
  /// Loose, about `first`, displacements at first. `position`: of nodes at rest; `component`: of each node, that of the
  /// graph. Blocks with nodes of several of these, or with points that do not reproduce affine fields, are in double
  /// precision still. Refers to `position`, too.
  BlockStrain(const MaterialPoints& points, const std::vector<Vec3>& position,
              const std::vector<std::uint32_t>& component, const std::vector<Vec3>& first);

  const MaterialPoints& points() const { return points_; }
  /// At the points of a block, in order; what stands beside the last is zero.
  void gradients(std::size_t block, const std::vector<Vec3>& u, Room& room, Columns<double>& out) const;
  /// Σ stress · shape gradient, four numbers a node of the block.
  void pull(std::size_t block, const Columns<double>& stress, Room& room, double* out) const;

 private:
  struct Motion {
    Mat3 gradient;
    bool known = false;
  };
  bool loose(std::size_t block) const { return !motion_.empty() && motion_[block].known; }
  const MaterialPoints& points_;
  const std::vector<Vec3>* position_ = nullptr;
  std::vector<Motion> motion_;  // per block, where this is loose
};

}  // namespace geo
