// Moving least squares with a linear basis: gradients of shape functions at a point (Belytschko, Lu and Gu 1994).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// How well the nodes around a point span space. `full`: a well-conditioned moment matrix, if need be with a wider
/// support; `regularised`: an ill-conditioned one, or, at nodes, with a direction left out; `rigid`: none, the point
/// carries no strain.
enum class Rung : std::uint8_t { full, regularised, rigid };

/// The nodes of a point and the gradients of their shape functions: ∇u = Σ u_j gᵀ_j, exact where u is linear.
struct ShapeRow {
  std::vector<std::uint32_t> to;  ///< ascending
  std::vector<Vec3> gradient;     ///< 1/model unit; they sum to zero
};

/// A node as a point sees it, straight ahead or round the front of a crack.
struct Sight {
  Vec3 node;
  double distance = 0;        ///< that its weight goes by, less than `reach`
  Vec3 slope = Vec3::Zero();  ///< of the distance, as the point moves
  double reach = 0;           ///< the node's support
};

/// Straight ahead.
Sight sight(const Vec3& x, const Vec3& node, double reach);

/// Full derivatives (the weights' and the moment matrix' own included) at x of the functions φ_j = pᵀ M⁻¹ p_j w_j, with
/// M = Σ w p pᵀ and w = 1 − 6 s² + 8 s³ − 3 s⁴, s the distance to node j over its support. Returns the condition of the
/// scaled moment matrix, infinite when there are fewer than four nodes or they are coplanar: then `gradient` is empty.
double shape_gradients(const Vec3& x, std::span<const Sight> nodes, std::vector<Vec3>& gradient);

}  // namespace geo
