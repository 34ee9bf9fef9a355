// Elastic energy and internal forces of one block of material points.
#pragma once

#include "mechanics/discretisation/block_strain.h"
#include "mechanics/material/elastic_lanes.h"

namespace geo {

/// Evaluates blocks, one at a time; each thread has an evaluator and a scratch of its own.
class ElasticBlock {
 public:
  /// Memory of one thread, reused from block to block.
  struct Scratch {
    BlockStrain::Scratch strain;
    PointMatrices<double> gradient;
    std::vector<double> volume, energy;
    struct {
      PointMatrices<double> gradient;
      std::vector<double> energy;
      PointMatrices<float> elastic_gradient;
    } mixed;  ///< results of all points in ranges of mixed materials
  };
  /// Keeps references to `scratch` and `strain`. `dt`: the time step, s, for viscosity.
  ElasticBlock(Scratch& scratch, const BlockStrain& strain, const Materials& materials, double dt = 1);
  /// Evaluates a block at nodal displacements u. A point's material decides which parts of the
  /// history it uses; with prestretch, all points relax. `elastic_gradient`, unless null: the
  /// elastic deformation gradient of its
  /// points, less the identity. `force`, unless null: Σ stress · shape gradient, four numbers per
  /// node of the block. Returns each point's energy, J; padding is zero.
  const std::vector<double>& evaluate(std::size_t block, const std::vector<Vec3>& u, const PointHistory& history,
                                      PointMatrices<float>* elastic_gradient, double* force);

 private:
  void evaluate_range(const PointBlock& block, const MaterialRange& range, const PointHistory& history,
                      PointMatrices<float>* elastic_gradient);

  Scratch& scratch_;
  const BlockStrain& strain_;
  std::vector<ElasticConstants> constants_;  // per material
};

}  // namespace geo
