// The inner loops over material points, in vectors: three coordinates side by side, or points side by side.
#pragma once

#include <cstddef>
#include <vector>

#include "mechanics/elasticity.h"
#include "mechanics/material_points.h"

namespace geo {

/// Matrices of points by columns: column c of point i is at column[c] + 4 i, its fourth number is of no account.
template <class Number>
struct Columns {
  std::vector<Number> column[3];
  void resize(std::size_t points);
};

/// ∇ of a nodal field at the points of a block; `values`: four numbers a node of the block, the last of no account.
void point_gradients(const PointBlock& block, const double* values, Columns<double>& out);
/// Adds Σ stress · shape gradient of the block's points to four numbers a node of the block.
void point_divergence(const PointBlock& block, const Columns<double>& stress, double* out);

/// ∂²Ψ/∂F² at points, made positive, by the singular value decomposition F = U Σ Vᵀ (both rotations): in that frame a
/// stress S' = Uᵀ S V depends on G' = Uᵀ ∂F V by a 3 × 3 matrix between the diagonals and three 2 × 2 ones between (i, j)
/// and (j, i) (Stomakhin et al. 2012, Smith, de Goes and Kim 2018). Number k of point i is at k · stride + i.
struct StiffnessModes {
  static constexpr std::size_t numbers = 30;  // U, V by columns; A00 A11 A22 A01 A02 A12; of pairs 01, 02, 12: own, other
  std::size_t stride = 0;
  std::vector<float> values;
};
/// `gradient`: ∇u; stiffness is times `weight`, one a point, a multiple of eight of them.
void stiffness_modes(const StiffnessConstants& constants, const Columns<float>& gradient, const std::vector<float>& weight, StiffnessModes& out);
/// Adds the stiffness times a nodal field: `values` as for point_gradients, `out` as for point_divergence.
void multiply_stiffness(const PointBlock& block, const StiffnessModes& modes, const float* values, float* out);

}  // namespace geo
