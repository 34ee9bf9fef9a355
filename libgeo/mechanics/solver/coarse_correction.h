// Second level of the preconditioner: aggregates of nodes move as rigid bodies. It finds at once
// the motions of large parts against each other, for which subdomains need many iterations (Mandel
// 1993; unsmoothed aggregation).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/discretisation/material_points.h"
#include "mechanics/solver/aggregates.h"
#include "mechanics/solver/band_cholesky.h"
#include "mechanics/solver/islands.h"
#include "mechanics/solver/point_stiffness.h"

namespace geo {

/// Galerkin projection onto the coarse space: P maps six rigid motions per aggregate to
/// displacements of its free nodes.
class CoarseCorrection {
 public:
  /// `at`: positions of nodes now; `fixed`: as in Environment. Refers to `aggregates`.
  CoarseCorrection(const Aggregates& aggregates, const std::vector<Vec3>& at, const std::vector<std::uint8_t>& fixed);
  /// Assembles and factors Pᵀ K P. K: an isotropic stiffness of the points, corotated by their
  /// rotations UVᵀ, summed over every `stride`-th point with as many times its weight, and the
  /// diagonal blocks of nodes. `moduli`: per material.
  void factor(const MaterialPoints& points, const PointStiffness& stiffness, std::span<const Moduli> moduli,
              std::size_t stride, const std::vector<Mat3>& blocks);
  /// Computes 0.4 (Pᵀ K P)⁻¹ Pᵀ r for the active islands; at() returns P of it. Precondition:
  /// factor().
  void solve(const std::vector<Vec3>& r, const ActiveIslands& active);
  /// The correction at a node; zero where it is fixed.
  Vec3 at(std::size_t node) const {
    if (!free_[node]) return Vec3::Zero();
    const float* const motion = &motion_[6 * aggregates_.of[node]];
    return Eigen::Map<const Eigen::Vector3f>(motion).cast<double>() +
           Eigen::Map<const Eigen::Vector3f>(motion + 3).cast<double>().cross(arm_[node]);
  }

 private:
  struct BlockTiles;
  BlockTiles block_tiles(const PointBlock& block, std::size_t b, const PointStiffness& stiffness,
                         std::span<const Moduli> moduli, std::size_t stride) const;
  void add_nodal_blocks(const std::vector<Mat3>& blocks);

  const Aggregates& aggregates_;
  std::vector<std::uint32_t> first_, member_;  // per aggregate and one more; free nodes by aggregate
  std::vector<Vec3> arm_;                      // per node: from the centre of its aggregate's free nodes
  std::vector<char> free_;                     // per node
  BandCholesky matrix_;
  std::vector<float> motion_;  // per aggregate: translation, rotation vector
};

}  // namespace geo
