// What points have for the preconditioner's second level, in vectors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/material_points.h"
#include "mechanics/stiffness_lanes.h"

namespace geo {

/// Tiles of six rows with eight numbers each, of which the last two are zero.
constexpr std::size_t tile = 48;

/// Adds, for each pair s ≥ t of the slots that nodes of a block belong to, the small-strain stiffness of their six rigid
/// motions, corotated, to tile s (s + 1) / 2 + t; of every `stride`-th point, as many times. `moduli`: per material; `arm`: four numbers a node of the
/// block, from the middle of its slot's nodes, and 1, or all zero for a node that is held.
void rigid_stiffness(const PointBlock& block, const StiffnessModes& modes, const std::vector<float>& weight, std::span<const Moduli> moduli, std::size_t stride,
                     std::span<const std::uint16_t> slot, const float* arm, float* out);

}  // namespace geo
