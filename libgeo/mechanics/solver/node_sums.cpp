#include "mechanics/solver/node_sums.h"

#include <algorithm>

#include "base/uninitialized_array.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/point_lanes.h"
#include "mechanics/material/plasticity.h"

namespace geo {

std::vector<StressSums> node_sums(const Solid& solid, const NodeSet& nodes, const State& state,
                                  const BlockStress& stress) {
  constexpr std::size_t width = 8, used = std::tuple_size_v<StressSums>;
  const MaterialPoints& points = solid.points();
  UninitializedArray<float> parts(width * points.scatter_size());
  parallel_for(points.blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<double> values;
    std::vector<float> place, own;
    PointMatrices<double> gradient;
    for (std::size_t b = begin; b < end; ++b) {
      const PointBlock& block = points.blocks[b];
      const Vec3 base = 0.5 * (block.box.lo + block.box.hi);
      place.clear();
      for (const auto j : block.nodes) {
        const Vec3 x = nodes.position[j] - base;
        place.insert(place.end(),
                     {float(x[0]), float(x[1]), float(x[2]), float(1 / (nodes.radius[j] * nodes.radius[j]))});
      }
      points.gather(b, state.displacement, values);
      point_gradients(block, values.data(), gradient);
      own.assign(width * ((block.points.size() + 7) / 8 * 8), 0);
      stress(b, gradient, own.data());
      for (std::size_t i = 0; i < block.points.size(); ++i)
        if (block.points[i].quality == MomentQuality::singular) own[width * i + used - 1] = 0;
      float* const sums = parts.data() + width * points.scatter_offset(b);
      std::fill_n(sums, width * block.nodes.size(), 0.0f);
      add_kernel_weighted(block, base, place.data(), own.data(), sums);
    }
  });
  std::vector<StressSums> sums(nodes.size());
  parallel_for(sums.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto sum = points.sum_at_node<width>(parts.data(), i);
      std::copy_n(sum.begin(), used, sums[i].begin());
    }
  });
  return sums;
}

std::vector<StressSums> node_sums(const Solid& solid, const NodeSet& nodes, const State& state,
                                  const PointStress& stress) {
  const MaterialPoints& points = solid.points();
  return node_sums(solid, nodes, state, [&](std::size_t b, const PointMatrices<double>& gradient, float* own) {
    const PointBlock& block = points.blocks[b];
    std::array<double, 6> numbers;
    for (std::size_t i = 0; i < block.points.size(); ++i) {
      if (block.points[i].quality == MomentQuality::singular) continue;
      Mat3 all = Mat3::Identity();
      for (int c = 0; c < 3; ++c) all.col(c) += Eigen::Map<const Vec3>(&gradient.column[c][4 * i]);
      const Mat3 elastic =
          state.plastic.empty() ? all : Mat3(all * inverse_plastic_stretch(state.plastic[points.first_point(b) + i]));
      if (!stress(solid.materials()[block.points[i].material], all, elastic, numbers)) continue;
      std::copy(numbers.begin(), numbers.end(), own + 8 * i), own[8 * i + 6] = 1;
    }
  });
}

}  // namespace geo
