// Sums over a node's neighbours in vector registers. All targets give the same bits.
#pragma once

#include <cstdint>
#include <span>

#include "kerf/vec.h"
#include "mechanics/terms/weighted_sum_lanes.h"

namespace geo {

/// A 3×3 matrix by columns, each padded with a zero.
struct alignas(32) PaddedMat3 {
  double at[3][4];
};

/// ∇u at a node: Σ (values[neighbour] − values[node]) gᵀ, g the shape gradient of each neighbour.
PaddedMat3 mls_gradient(std::span<const std::uint32_t> neighbors, const Vec3* g, const PaddedVec3* values,
                        std::uint32_t node);

/// The affine motion of each node in Eq. 1, as arrays over the nodes.
struct AffineNodes {
  const PaddedVec3* place;  ///< position at rest; in the padding, 1 / support²
  const PaddedVec3* displacement;
  const PaddedMat3* gradient;
};
/// Eq. 1 at a node's own position: the displacement blended from the node and its neighbours.
PaddedVec3 blended_displacement(std::span<const std::uint32_t> neighbors, const AffineNodes& nodes, std::uint32_t node);

}  // namespace geo
