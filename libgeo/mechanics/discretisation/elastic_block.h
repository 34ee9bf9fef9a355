// Elastic energy and forces of one block of material points.
#pragma once

#include "mechanics/discretisation/block_strain.h"
#include "mechanics/discretisation/elastic_lanes.h"

namespace geo {

/// A point's material decides which of the history it has.
class ElasticBlock {
 public:
  /// What one block leaves is room for the next. Of one thread.
  struct Room {
    BlockStrain::Room strain;
    Columns<double> gradient;
    std::vector<double> volume, energy;
    struct {
      Columns<double> gradient;
      std::vector<double> energy;
      Columns<float> deformed;
    } aside;
  };
  /// Refers to `strain` and `room`.
  ElasticBlock(Room& room, const BlockStrain& strain, const Materials& materials, double dt = 1);
  /// At nodal displacements u. `deformed`, where given: F of its points, less 1; `pull`, where given: Σ stress · shape
  /// gradient, four numbers a node of the block. Returns each point's energy, J; what follows the last one's is zero.
  const std::vector<double>& evaluate(std::size_t block, const std::vector<Vec3>& u, const PointHistory& history,
                                      Columns<float>* deformed, double* pull);

 private:
  void evaluate_run(const PointBlock& block, const MaterialRun& run, const PointHistory& history,
                    Columns<float>* deformed);
  Room& room_;
  const BlockStrain& strain_;
  std::vector<ElasticConstants> constants_;  // per material
};

}  // namespace geo
