// The stiffness of material points, by the singular value decomposition of what deforms them, eight points side by
// side.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/material.h"
#include "kerf/vec.h"
#include "mechanics/discretisation/point_lanes.h"

namespace geo {

/// ∂²Ψ/∂F² at points, made positive, by the singular value decomposition F = U Σ Vᵀ (both rotations): in that frame a
/// stress S' = Uᵀ S V depends on G' = Uᵀ ∂F V by a 3 × 3 matrix between the diagonals and three 2 × 2 ones between (i,
/// j) and (j, i) (Stomakhin et al. 2012, Smith, de Goes and Kim 2018). Eight points stand side by side: number k of n
/// that point i has is at number(i, n) + 8 k.
struct StiffnessModes {
  static constexpr float full = 32767;
  std::size_t points = 0;           ///< a multiple of eight
  std::vector<std::int16_t> frame;  ///< 18 numbers: U and V by columns, in shares of `full`
  std::vector<float> stiffness;     ///< 12: A00 A11 A22 A01 A02 A12; of pairs 01, 02, 12: own, other
  static std::size_t number(std::size_t point, std::size_t n) { return 8 * n * (point / 8) + point % 8; }
  void resize(std::size_t count) { points = count, frame.resize(18 * count), stiffness.resize(12 * count); }
  /// All that another has for a point.
  void take(const StiffnessModes& from, std::size_t point);
  /// U Vᵀ
  Eigen::Matrix3f rotation(std::size_t point) const;
};
/// From point `begin` to `end`, both multiples of eight, of an `out` that has room for all. `gradient`: ∇u; where
/// material has flown, of F times `relaxed` (symmetric), by which gradients and stresses are then multiplied, too: null
/// where it has not. Stiffness is times `weight`, one a point, a multiple of eight of them.
void stiffness_modes(const StiffnessConstants& constants, std::size_t begin, std::size_t end,
                     const Columns<float>& gradient, const Columns<float>* relaxed, const std::vector<float>& weight,
                     StiffnessModes& out);

}  // namespace geo
