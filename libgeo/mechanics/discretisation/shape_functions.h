// Moving least squares with a linear basis: gradients of shape functions at a point (Belytschko, Lu
// and Gu 1994). Legend: φ_j shape function and w_j weight of node j, p = (1, x) basis, M = Σ w_j
// p_j p_jᵀ moment matrix.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/vec.h"

namespace geo {

/// The quality of the moment matrix at a point. `good`: full rank and well-conditioned, if need be
/// with a wider support. `poor`: at nodes, of lower rank. `singular`: the point carries no strain.
enum class MomentQuality : std::uint8_t { good, poor, singular };

/// Gradients of a point's shape functions: ∇u = Σ u_j gradient_jᵀ, exact where u is linear.
struct ShapeGradients {
  std::vector<std::uint32_t> nodes;     ///< ascending
  std::vector<Vec3> gradient;           ///< one per node, 1/model unit; they sum to zero
  std::vector<std::uint8_t> bent = {};  ///< per node: 1 if the point sees it round the front of a crack; empty: none
  std::vector<double> value = {};       ///< per node: the shape function itself; empty: unknown
};

/// A node whose support holds a point, as the point sees it: straight ahead or round the front of a
/// crack.
struct SupportNode {
  Vec3 position;
  double distance = 0;                    ///< argument of its weight function, less than `support`
  Vec3 distance_gradient = Vec3::Zero();  ///< derivative of `distance` by the point's position
  double support = 0;                     ///< support radius
};

/// A node that no face hides from x; round a crack front, see diffracted_support(). Precondition:
/// |x − node| < support.
SupportNode direct_support(const Vec3& x, const Vec3& node, double support);

/// Full derivatives (weights and moment matrix differentiated, too) at x of φ_j = pᵀ M⁻¹ p_j w_j,
/// with the quartic spline w = 1 − 6 s² + 8 s³ − 3 s⁴ and s the distance over the support. One
/// gradient per element of `nodes`, 1/model unit, and one φ_j in `value` unless that is null.
/// Returns the condition number of M, with lengths in units of the mean support, or an upper bound
/// that is less than `enough`. It is infinite, and `gradient` empty, for fewer than four nodes or
/// coplanar ones.
double shape_gradients(const Vec3& x, std::span<const SupportNode> nodes, std::vector<Vec3>& gradient,
                       std::vector<double>* value = nullptr, double enough = 0);

}  // namespace geo
