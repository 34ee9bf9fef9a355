// The as-rigid-as-possible energy (Sorkine and Alexa 2007) of nodes that too few material points
// strain: a basis of lower order where a thin piece holds hardly any point.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/vec.h"
#include "mechanics/discretisation/nodal_gradients.h"

namespace geo {

/// A star is a node with its neighbours, an arm one of these.
/// E = Σ_i ½ k_i min_R Σ_j ŵ_ij |x_j − x_i − R x_ij|² with x the positions now, x_ij the offsets at
/// rest and ŵ_ij the normalised weights (NodalGradientOperator::Node). A rotation of the whole has
/// no energy. Where neighbours do not span space, the rotation about their axis is of no effect.
class AsRigidEnergy {
 public:
  /// Without nodes.
  AsRigidEnergy() = default;
  /// `stiffness`: per node, k_i = E V_i times what is missing, J; nodes with 0 are left out.
  AsRigidEnergy(const NodalGradientOperator& gradients, const std::vector<double>& stiffness);
  /// Whether no node is in it.
  bool empty() const { return stars_.empty(); }
  /// The number of nodes that are in it.
  std::size_t size() const { return stars_.size(); }
  /// The node of the k-th star.
  std::uint32_t node(std::size_t k) const { return stars_[k].node; }

  /// The energy of a star at displacements u, J, and its best rotation R.
  double energy(std::size_t k, const std::vector<Vec3>& u, Mat3& rotation) const;
  /// Adds −∂E/∂u of a star to `force`, N. `rotation`: of energy() at u.
  void add_force(std::size_t k, const std::vector<Vec3>& u, const Mat3& rotation, std::vector<Vec3>& force) const;
  /// Adds H p of a star to `out`: the Hessian where its rotation is R and nothing is strained.
  /// Elsewhere the true one may be indefinite; this one never is.
  void add_product(std::size_t k, const Mat3& rotation, const std::vector<Vec3>& p, std::vector<Vec3>& out) const;
  /// Adds the diagonal of H without rotations, the same for all three coordinates: not less than
  /// that of H. Half of the largest eigenvalue of H is at most the largest of these.
  void add_diagonal(std::vector<double>& diagonal) const;

 private:
  struct Star {
    std::uint32_t node, begin, end;  // its arms
    Mat3 inverse_inertia;            // pseudo-inverse of Σ k ŵ (|x|² 1 − x xᵀ)
  };
  struct Arm {
    std::uint32_t to;
    double stiffness;  // k_i ŵ_ij, N/m
    Vec3 offset;       // x_ij
  };
  std::span<const Arm> arms(const Star& star) const { return {arms_.data() + star.begin, arms_.data() + star.end}; }

  std::vector<Star> stars_;
  std::vector<Arm> arms_;
};

}  // namespace geo
