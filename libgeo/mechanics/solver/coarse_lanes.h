// What points have for the preconditioner's second level, in vectors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/discretisation/material_points.h"
#include "mechanics/material/stiffness_lanes.h"

namespace geo {

/// Tiles of six rows with eight numbers each: of three translations, the first again, of three
/// rotations, the first again.
constexpr std::size_t tile = 48;
/// Where a motion's number is among eight.
constexpr std::size_t mode_at(std::size_t motion) { return motion + motion / 3; }

/// A node's arm, from the middle of its slot's nodes, in the order that motions' gradients take it:
/// 1 for the translations, then what the rotations multiply and what they take off. All zero for a
/// node that is held.
inline std::array<float, 16> arm_numbers(const Vec3& arm, bool free) {
  const float x = free ? float(arm.x()) : 0, y = free ? float(arm.y()) : 0, z = free ? float(arm.z()) : 0,
              one = free ? 1 : 0;
  return {one, one, one, one, y, z, x, y, 0, 0, 0, 0, z, x, y, z};
}

/// Adds, for each pair s ≥ t of the slots that nodes of a block belong to, the small-strain
/// stiffness of their six rigid motions, corotated, to tile s (s + 1) / 2 + t; of every `stride`-th
/// point, as many times. `moduli`: per material; `arm`: sixteen numbers a node of the block, as
/// arm_numbers() makes them.
void rigid_stiffness(const PointBlock& block, const StiffnessModes& modes, const std::vector<float>& weight,
                     std::span<const Moduli> moduli, std::size_t stride, std::span<const std::uint16_t> slot,
                     const float* arm, float* out);

}  // namespace geo
