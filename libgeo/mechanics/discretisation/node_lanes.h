// The inner loops over a node's neighbours, in vectors. The same numbers for any processor.
#pragma once

#include <cstdint>
#include <span>

#include "kerf/vec.h"
#include "mechanics/terms/weighted_sum_lanes.h"

namespace geo {

/// A 3×3 matrix, a zero below each column.
struct alignas(32) FourColumns {
  double at[3][4];
};

/// Σ (values[to] − values[own]) gᵀ.
FourColumns row_gradient(std::span<const std::uint32_t> to, const Vec3* g, const PaddedVec3* values, std::uint32_t own);

/// What Eq. 1 takes from a node: its place at rest with 1 over the square of its radius; its
/// displacement and gradient.
struct MovedNodes {
  const PaddedVec3 *place, *displacement;
  const FourColumns* gradient;
};
/// Where Eq. 1 has the displacement of the material at node `own`, of itself and of those that it
/// sees (`to`).
PaddedVec3 moved_by(std::span<const std::uint32_t> to, const MovedNodes& nodes, std::uint32_t own);

}  // namespace geo
