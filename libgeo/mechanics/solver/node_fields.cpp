// material_displacement() and von_mises_stress() of kerf/solid.h. Fields for pictures: Eq. 1 at the
// nodes' own positions, and the von Mises stress √(½ Σ (σ_ii − σ_jj)² + 3 Σ σ_ij²), over pairs i <
// j, of the averaged stress.
#include <algorithm>
#include <cmath>

#include "kerf/parallel.h"
#include "kerf/solid.h"
#include "mechanics/material/elastic_lanes.h"
#include "mechanics/solver/nodal_averages.h"
#include "mechanics/solver/relaxation.h"
#include "mechanics/solver/solid_discretisation.h"
#include "mechanics/terms/weighted_sums.h"

namespace geo {
namespace {

double von_mises(const StressSums& sum) {
  const double xy = sum[0] - sum[1], yz = sum[1] - sum[2], zx = sum[2] - sum[0];
  return std::sqrt(0.5 * (xy * xy + yz * yz + zx * zx) + 3 * (sum[3] * sum[3] + sum[4] * sum[4] + sum[5] * sum[5])) /
         sum[6];
}

}  // namespace

std::vector<Vec3> material_displacement(const Solid& solid, const NodeSet& nodes, const VisibilityGraph& graph,
                                        const State& state) {
  const auto gradient = SolidDiscretisation::of(solid).mls.padded_gradients(state.displacement);
  const std::vector<PaddedVec3> displacement = padded(state.displacement);
  std::vector<PaddedVec3> place = padded(nodes.position);
  for (std::size_t i = 0; i < place.size(); ++i) place[i].at[3] = 1 / (nodes.radius[i] * nodes.radius[i]);
  const AffineNodes all{place.data(), displacement.data(), gradient.data()};
  std::vector<Vec3> moved(nodes.size());
  parallel_for(nodes.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> to;
    for (std::size_t i = begin; i < end; ++i) {
      to.clear();
      for (const auto& n : graph.neighbors(nodes, NodeId(i))) to.push_back(n.to.value);
      const PaddedVec3 at = blended_displacement(to, all, static_cast<std::uint32_t>(i));
      moved[i] = {at.at[0], at.at[1], at.at[2]};
    }
  });
  return moved;
}

std::vector<double> von_mises_stress(const Solid& solid, const NodeSet& nodes, const State& state) {
  const MaterialPoints& points = SolidDiscretisation::of(solid).points;
  std::vector<ElasticConstants> constants;  // per material
  for (const Material& m : solid.materials().all()) constants.push_back(elastic_constants(m));
  const auto block_stress = [&](std::size_t b, const PointMatrices<double>& gradient, float* out) {
    const PointBlock& block = points.blocks[b];
    const PointRelaxation relaxation = relaxation_of(points, b, state);
    // In a range of mixed materials, all points are computed with the range's material, and results
    // of other materials' points are dropped.
    std::vector<float> scratch(8 * ((block.points.size() + 7) / 8 * 8));
    for (const MaterialRange& run : block.material_ranges) {
      cauchy_stresses(constants[run.material], {run.begin, run.end}, relaxation.history().relaxation, gradient,
                      run.uniform ? out : scratch.data());
      for (std::size_t i = run.begin; i < std::min<std::size_t>(run.end, block.points.size()) && !run.uniform; ++i)
        if (block.belongs_to(run, i)) std::copy_n(&scratch[8 * i], 8, out + 8 * i);
    }
  };
  const auto sums = nodal_stress_sums(solid, nodes, state, BlockStress(block_stress));
  std::vector<double> result(nodes.size(), 0);
  for (std::size_t i = 0; i < sums.size(); ++i)
    if (sums[i][6] > 0) result[i] = von_mises(sums[i]);
  return result;
}

}  // namespace geo
