// Positive semidefinite stiffness of many material points in the principal frames of their
// deformation gradients, in vector registers.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/vec.h"
#include "mechanics/material/elastic_lanes.h"
#include "mechanics/material/point_matrices.h"
#include "mechanics/material/stress_derivative.h"

namespace geo {

/// ∂²Ψ/∂F² at points, projected to be positive semidefinite, by the singular value decomposition F
/// = U Σ Vᵀ with rotations U and V. In the principal frame, S' = Uᵀ S V depends on G' = Uᵀ ∂F V by
/// a 3×3 matrix A between the diagonals and a 2×2 one between each pair (i, j), (j, i) (Stomakhin
/// et al. 2012; Smith, de Goes and Kim 2018). Storage interleaves eight points: the k-th of n
/// numbers of point i is at offset(i, n) + 8 k.
struct StiffnessModes {
  static constexpr float frame_scale = 32767;  ///< the integer that stands for 1 in `frame`
  std::size_t points = 0;                      ///< a multiple of eight
  std::vector<std::int16_t> frame;             ///< 18 numbers: U and V by columns, times frame_scale
  /// 12 numbers: A00 A11 A22 A01 A02 A12; then, for pairs 01, 02, 12, the diagonal and off-diagonal
  /// entry.
  std::vector<float> stiffness;

  /// The index of a point's first number if each point has n.
  static std::size_t offset(std::size_t point, std::size_t n) { return 8 * n * (point / 8) + point % 8; }
  /// Makes space for `count` points, a multiple of eight.
  void resize(std::size_t count) {
    points = count;
    frame.resize(18 * count);
    stiffness.resize(12 * count);
  }
  /// Copies all numbers of one point from the same point of `from`.
  void copy_point(const StiffnessModes& from, std::size_t point);
  /// The rotation U Vᵀ of a point.
  Eigen::Matrix3f rotation(std::size_t point) const;
};

/// Computes the modes of points in `range`, times `weight` (one per point, a multiple of eight of
/// them), into `out`, which must be large enough. `elastic_gradient`: the elastic deformation
/// gradient less the identity. `relaxation`, unless null: symmetric matrices by which gradients and
/// stresses are multiplied, too.
void stiffness_modes(const StiffnessConstants& constants, PointRange range,
                     const PointMatrices<float>& elastic_gradient, const PointMatrices<float>* relaxation,
                     const std::vector<float>& weight, StiffnessModes& out);

}  // namespace geo
