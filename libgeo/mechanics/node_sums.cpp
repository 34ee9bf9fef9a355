#include "mechanics/node_sums.h"

#include <algorithm>

#include "base/parallel.h"
#include "mechanics/plasticity.h"

namespace geo {

std::vector<StressSums> node_sums(const Solid& solid, const NodeSet& nodes, const State& state, const PointStress& stress) {
  constexpr std::size_t width = std::tuple_size_v<StressSums>;
  const MaterialPoints& points = solid.points();
  std::vector<double> parts(width * points.parts(), 0), inverse(nodes.size());  // of supports, squared
  for (std::size_t i = 0; i < nodes.size(); ++i) inverse[i] = 1 / (nodes.radius[i] * nodes.radius[i]);
  parallel_for(points.blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::array<double, 6> own;
    for (std::size_t b = begin; b < end; ++b) {
      const PointBlock& block = points.blocks[b];
      const auto gradient = points.gradients(b, state.displacement);
      for (std::size_t i = 0; i < block.points.size(); ++i) {
        const MaterialPoint& p = block.points[i];
        const Mat3 all = Mat3::Identity() + gradient[i];
        const Mat3 elastic = state.plastic.empty() ? all : Mat3(all * relaxation(state.plastic[points.first(b) + i]));
        if (p.rung == Rung::rigid || !stress(solid.materials()[p.material], all, elastic, own)) continue;
        for (auto e = block.first[i]; e < block.first[i + 1]; ++e) {
          const std::uint32_t node = block.nodes[block.to[e]];
          const double left = 1 - (p.position - nodes.position[node]).squaredNorm() * inverse[node];  // the kernel, but for its scale
          if (!(left > 0)) continue;
          const double w = p.volume * left * left * left;
          double* sum = &parts[width * (points.part(b) + block.to[e])];
          for (const double c : own) *sum++ += w * c;
          *sum += w;
        }
      }
    }
  });
  std::vector<StressSums> sums(nodes.size(), StressSums{});
  parallel_for(sums.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) sums[i] = points.sum<width>(parts.data(), i);
  });
  return sums;
}

}  // namespace geo
