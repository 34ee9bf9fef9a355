// Σ_p V_p ω(|x_p − x_i| / h_i) σ_p for node i: each block of points sums into slots of its own,
// then each node adds up its slots.
#include "mechanics/solver/nodal_averages.h"

#include <algorithm>

#include "base/uninitialized_array.h"
#include "kerf/parallel.h"
#include "mechanics/solver/relaxation.h"
#include "mechanics/solver/solid_discretisation.h"

namespace geo {

std::vector<StressSums> nodal_stress_sums(const Solid& solid, const NodeSet& nodes, const State& state,
                                          const BlockStress& stress) {
  constexpr std::size_t width = 8, used = std::tuple_size_v<StressSums>;
  const MaterialPoints& points = SolidDiscretisation::of(solid).points;
  UninitializedArray<float> block_sums(width * points.scatter_size());
  parallel_for(points.blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<double> values;
    std::vector<float> support, of_points;
    PointMatrices<double> gradient;
    for (std::size_t b = begin; b < end; ++b) {
      const PointBlock& block = points.blocks[b];
      const Vec3 base = 0.5 * (block.box.lo + block.box.hi);
      support.clear();
      for (const auto j : block.nodes) {
        const Vec3 x = nodes.position[j] - base;
        support.insert(support.end(),
                       {float(x[0]), float(x[1]), float(x[2]), float(1 / (nodes.radius[j] * nodes.radius[j]))});
      }
      points.gather(b, state.displacement, values);
      point_gradients(block, values.data(), gradient);
      of_points.assign(width * ((block.points.size() + 7) / 8 * 8), 0);
      stress(b, gradient, of_points.data());
      for (std::size_t i = 0; i < block.points.size(); ++i)
        if (block.points[i].quality == MomentQuality::singular) of_points[width * i + used - 1] = 0;
      float* const sums = block_sums.data() + width * points.scatter_offset(b);
      std::fill_n(sums, width * block.nodes.size(), 0.0f);
      add_kernel_weighted(block, base, support.data(), of_points.data(), sums);
    }
  });
  std::vector<StressSums> sums(nodes.size());
  parallel_for(sums.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto sum = points.sum_at_node<width>(block_sums.data(), i);
      std::copy_n(sum.begin(), used, sums[i].begin());
    }
  });
  return sums;
}

std::vector<StressSums> nodal_stress_sums(const Solid& solid, const NodeSet& nodes, const State& state,
                                          const PointStress& stress) {
  const MaterialPoints& points = SolidDiscretisation::of(solid).points;
  const auto block_stress = [&](std::size_t b, const PointMatrices<double>& gradient, float* out) {
    const PointBlock& block = points.blocks[b];
    const PointRelaxation relaxation = relaxation_of(points, b, state);
    std::array<double, 6> components;
    for (std::size_t i = 0; i < block.points.size(); ++i) {
      if (block.points[i].quality == MomentQuality::singular) continue;
      Mat3 f = Mat3::Identity();
      for (int c = 0; c < 3; ++c) f.col(c) += Eigen::Map<const Vec3>(&gradient.column[c][4 * i]);
      const Mat3 elastic = relaxation.empty() ? f : Mat3(f * relaxation.at(i));
      if (!stress(solid.materials()[block.points[i].material], f, elastic, components)) continue;
      std::copy(components.begin(), components.end(), out + 8 * i);
      out[8 * i + 6] = 1;
    }
  };
  return nodal_stress_sums(solid, nodes, state, BlockStress(block_stress));
}

}  // namespace geo
