// Inner loop of the coarse correction in vectors: the stiffness of points for the rigid motions of
// aggregates.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/discretisation/material_points.h"
#include "mechanics/material/stiffness_lanes.h"
#include "mechanics/material/stress_derivative.h"

namespace geo {

/// Numbers of a tile: six rows of eight numbers, of which those of three translations stand at 0 to
/// 2, repeated at 3, and those of three rotations at 4 to 6, repeated at 7.
constexpr std::size_t tile = 48;
/// Index among these eight numbers of motion 0 to 5.
constexpr std::size_t mode_at(std::size_t motion) { return motion + motion / 3; }

/// A node's arm (from the centre of its aggregate) in the layout of rigid_stiffness(): two rows of
/// eight factors, whose products with the columns of a rotation are subtracted; for translations 1
/// and 0, for rotations those of a cross product. All zero for a fixed node.
inline std::array<float, 16> arm_numbers(const Vec3& arm, bool free) {
  const float x = free ? float(arm.x()) : 0, y = free ? float(arm.y()) : 0, z = free ? float(arm.z()) : 0,
              one = free ? 1 : 0;
  return {one, one, one, one, y, z, x, y, 0, 0, 0, 0, z, x, y, z};
}

/// Points of one block whose stiffness is summed. Refers to everything.
struct CorotatedPoints {
  const PointBlock& block;
  const StiffnessModes& modes;       ///< rotations of the points
  const std::vector<float>& weight;  ///< per point: volume, m³
  std::span<const Moduli> moduli;    ///< per material, of an isotropic stiffness
  std::size_t stride;                ///< every `stride`-th point counts, `stride` times
};

/// Adds to tile s (s + 1) / 2 + t, for each pair s ≥ t of slots, the corotated small-strain
/// stiffness between their rigid motions, summed over the points. `slot`: per node of the block,
/// the index of its aggregate; `arm`: per node of the block, arm_numbers().
void rigid_stiffness(const CorotatedPoints& points, std::span<const std::uint16_t> slot, const float* arm, float* out);

}  // namespace geo
