// The second level of the preconditioner: groups of nodes move as rigid bodies where they are now.
// What patches take long to find, motions of large parts against each other, is solved for at once
// (Mandel 1993; unsmoothed aggregation).
#pragma once

#include <cstdint>
#include <vector>

#include "mechanics/discretisation/material_points.h"
#include "mechanics/material/stiffness_lanes.h"
#include "mechanics/solver/band_factor.h"
#include "mechanics/solver/node_groups.h"
#include "mechanics/solver/step_parts.h"

namespace geo {

class CoarseMotion {
 public:
  /// `at`: where nodes are; `fixed`: as in Environment.
  CoarseMotion(const NodeGroups& groups, const std::vector<Vec3>& at, const std::vector<std::uint8_t>& fixed);
  /// The stiffness of points, isotropic and corotated (Σ w (shear |g|² 1 + shear g gᵀ + bulk g gᵀ),
  /// g turned by UVᵀ), of every `stride`-th as many times, and 3×3 blocks of nodes, for the groups'
  /// six motions each; factored. `moduli`: per material.
  void factor(const MaterialPoints& points, const std::vector<StiffnessModes>& modes,
              const std::vector<std::vector<float>>& weight, std::span<const Moduli> moduli, std::size_t stride,
              const std::vector<Mat3>& blocks);
  /// (Pᵀ K P)⁻¹ Pᵀ r of parts at work; then, at a node, 0.4 P of it: its share beside that of
  /// patches.
  void solve(const std::vector<Vec3>& r, const StepParts& parts);
  Vec3 at(std::size_t node) const {
    if (!free_[node]) return Vec3::Zero();
    const float* const motion = &values_[6 * groups_.of[node]];
    return Eigen::Map<const Eigen::Vector3f>(motion).cast<double>() +
           Eigen::Map<const Eigen::Vector3f>(motion + 3).cast<double>().cross(arm_[node]);
  }

 private:
  const NodeGroups& groups_;
  std::vector<std::uint32_t> first_, member_;  // per group and one more; nodes that are free, by group
  std::vector<Vec3> arm_;                      // from the middle of its group's free nodes
  std::vector<char> free_;
  BandFactor matrix_;
  std::vector<float> values_;
};

}  // namespace geo
