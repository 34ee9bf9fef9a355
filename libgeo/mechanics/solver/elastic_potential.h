// Elastic energy of a time step, its forces and its stiffness–vector product (matvec), island by
// island.
#pragma once

#include <vector>

#include "mechanics/discretisation/block_strain.h"
#include "mechanics/material/stiffness_lanes.h"
#include "mechanics/solver/islands.h"
#include "mechanics/solver/point_stiffness.h"
#include "mechanics/solver/step_problem.h"

namespace geo {

/// The elastic response at displacements that were evaluated: what forces and stiffness there are
/// computed from.
struct ElasticResponse {
  std::vector<double> energy;  ///< per island, J
  std::vector<Vec3> force;     ///< per node, −∂Ψ/∂u, N
  std::vector<PointMatrices<float>>
      deformation;             ///< per block and point: F − 1, or F times the relaxation − 1 where plastic
  std::vector<Mat3> rotation;  ///< per star of the as-rigid-as-possible energy
};

/// Elasticity and viscosity of a time step from problem.start on.
class ElasticPotential {
 public:
  /// Refers to the problem's solid.
  explicit ElasticPotential(const StepProblem& problem);

  /// energy[island] += elastic energy at u, J. Fills the response of the active islands where one
  /// is given.
  void evaluate(const ActiveIslands& active, const std::vector<Vec3>& u, std::vector<double>& energy,
                ElasticResponse* response);
  /// Recomputes the stiffness of points of active islands from a response that evaluate() filled.
  void linearise(const ActiveIslands& active, const ElasticResponse& response);
  /// Computes K p for the nodes of active islands, in single precision; product_at() returns it.
  void multiply(const ActiveIslands& active, const std::vector<Vec3>& p);
  /// K p at a node, after multiply(), N.
  Vec3 product_at(std::size_t node) const {
    const auto sum = solid_.points.sum_at_node<4>(block_products_.data(), node);
    const Vec3 product(sum[0], sum[1], sum[2]);
    return star_product_.empty() ? product : Vec3(product + star_product_[node]);
  }
  /// The stiffness of the last linearise().
  const PointStiffness& stiffness() const { return stiffness_; }

 private:
  double volume_of(std::size_t block, std::size_t point) const;
  void add_stars(const ActiveIslands& active, const std::vector<Vec3>& u, std::vector<double>& energy,
                 ElasticResponse* response) const;
  void linearise_block(std::size_t block, const std::vector<StiffnessConstants>& constants,
                       const PointMatrices<float>& deformation, PointMatrices<float>& relaxation,
                       StiffnessModes& scratch);

  const SolidDiscretisation& solid_;
  double dt_;
  BlockStrain strain_;
  std::vector<PointRelaxation> relaxation_;            // per block; empty: elasticity sees all of F
  std::vector<PointMatrices<double>> start_gradient_;  // per block: ∇u at the start of the step; empty: no viscosity
  PointStiffness stiffness_;
  std::vector<double> block_energy_;   // per block and island of the block
  std::vector<double> block_forces_;   // per block and node of the block, four numbers: ∂Ψ/∂u
  std::vector<float> block_products_;  // the same: K p
  std::vector<Mat3> rotation_;         // per star, of the last linearise()
  std::vector<Vec3> star_product_;     // per node: the part of K p by stars; empty: there are none
};

}  // namespace geo
