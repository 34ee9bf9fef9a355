#include "kerf/solid.h"

#include <algorithm>
#include <cmath>

#include "kerf/parallel.h"
#include "mechanics/material/elastic_lanes.h"
#include "mechanics/material/plasticity.h"
#include "mechanics/solver/node_sums.h"
#include "mechanics/terms/weighted_sums.h"

namespace geo {

std::vector<Vec3> material_displacement(const Solid& solid, const NodeSet& nodes, const VisibilityGraph& graph,
                                        const State& state) {
  const auto gradient = solid.gradient_columns(state.displacement);
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
  const MaterialPoints& points = solid.points();
  std::vector<ElasticConstants> constants;  // per material
  for (const Material& m : solid.materials().all()) constants.push_back(elastic_constants(m));
  const auto sums =
      node_sums(solid, nodes, state, [&](std::size_t b, const PointMatrices<double>& gradient, float* own) {
        const PointBlock& block = points.blocks[b];
        PointMatrices<double> relaxed;
        if (!state.plastic.empty()) {
          relaxed.resize(block.points.size());
          for (std::size_t i = 0; i < block.points.size(); ++i) {
            const Mat3 back = inverse_plastic_stretch(state.plastic[points.first_point(b) + i]);
            for (int c = 0; c < 3; ++c) Eigen::Map<Vec3>(&relaxed.column[c][4 * i]) = back.col(c);
          }
        }
        std::vector<float> aside(8 * ((block.points.size() + 7) / 8 * 8));
        for (const MaterialRange& run : block.material_ranges) {
          float* const to = run.uniform ? own : aside.data();
          cauchy_stresses(constants[run.material], {run.begin, run.end}, state.plastic.empty() ? nullptr : &relaxed,
                          gradient, to);
          for (std::size_t i = run.begin; i < std::min<std::size_t>(run.end, block.points.size()) && !run.uniform; ++i)
            if (block.belongs_to(run, i)) std::copy_n(&aside[8 * i], 8, own + 8 * i);
        }
      });
  std::vector<double> result(nodes.size(), 0);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const StressSums& sum = sums[i];
    if (!(sum[6] > 0)) continue;
    const double xy = sum[0] - sum[1], yz = sum[1] - sum[2], zx = sum[2] - sum[0];
    result[i] =
        std::sqrt(0.5 * (xy * xy + yz * yz + zx * zx) + 3 * (sum[3] * sum[3] + sum[4] * sum[4] + sum[5] * sum[5])) /
        sum[6];
  }
  return result;
}

}  // namespace geo
