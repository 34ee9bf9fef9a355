// Tensors at material points, over a cut: they stay with their points, and new points take the mean
// of the material about them.
#pragma once

#include <span>
#include <vector>

#include "kerf/vec.h"
#include "mechanics/discretisation/material_points.h"

namespace geo {

/// One tensor for each material point, as a cut changes the points.
class PointTransfer {
 public:
  /// Before the cut: takes the means about nodes near it. `field`: one per point, or empty;
  /// `position`: of the nodes; `changed`: per node, 1 where its shape function changes.
  PointTransfer(const MaterialPoints& points, const std::vector<Vec3>& position, std::span<const char> changed,
                const std::vector<Mat3>& field);
  /// After the cut: the tensors of the points as they are now. `old_point`: as PointChanges has it;
  /// `elsewhere`: for points that no material was about. Empty where the field was.
  std::vector<Mat3> after(const MaterialPoints& points, const std::vector<Vec3>& position,
                          std::span<const std::uint32_t> old_point, const Mat3& elsewhere) const;

 private:
  const std::vector<Mat3>& field_;
  std::vector<Mat3> sum_;       // per node: of the points that it supports, by weight and volume
  std::vector<double> weight_;  // per node
};

}  // namespace geo
