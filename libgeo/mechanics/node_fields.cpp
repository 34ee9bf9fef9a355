#include "mechanics/node_fields.h"

#include <cmath>

#include "base/parallel.h"
#include "mechanics/deformation.h"
#include "mechanics/kernel.h"
#include "mechanics/plasticity.h"

namespace geo {

std::vector<Vec3> material_displacement(const Solid& solid, const NodeSet& nodes, const VisibilityGraph& graph, const State& state) {
  const auto gradient = solid.gradients(state.displacement);
  std::vector<Vec3> moved(nodes.size());
  parallel_for(nodes.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<NodeId, double>> around;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& x = nodes.position[i];
      around.assign(1, {NodeId(i), 0.0});
      for (const auto& n : graph.neighbors(nodes, NodeId(i))) around.push_back({n.to, (x - nodes.position[n.to.index()]).norm()});
      moved[i] = displacement_at(x, around, nodes, state.displacement, gradient);
    }
  });
  return moved;
}

std::vector<double> von_mises_stress(const Solid& solid, const NodeSet& nodes, const State& state) {
  constexpr std::size_t width = 7;  // the symmetric stress, and the weight it is summed with
  const MaterialPoints& points = solid.points();
  std::vector<double> parts(width * points.parts(), 0);
  parallel_for(points.blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const PointBlock& block = points.blocks[b];
      const auto gradient = points.gradients(b, state.displacement);
      for (std::size_t i = 0; i < block.points.size(); ++i) {
        const MaterialPoint& p = block.points[i];
        Mat3 f = Mat3::Identity() + gradient[i];
        if (!state.plastic.empty()) f = f * relaxation(state.plastic[points.first(b) + i]);
        const double j = f.determinant();
        if (p.rung == Rung::rigid || !(j > 0)) continue;
        const Mat3 s = stress(solid.material(), f) * f.transpose() / j;
        for (auto e = block.first[i]; e < block.first[i + 1]; ++e) {
          const std::uint32_t node = block.nodes[block.to[e]];
          const double w = p.volume * kernel((p.position - nodes.position[node]).norm() / nodes.radius[node], 1.0);
          double* sum = &parts[width * (points.part(b) + block.to[e])];
          const double entries[] = {s(0, 0), s(1, 1), s(2, 2), 0.5 * (s(0, 1) + s(1, 0)), 0.5 * (s(1, 2) + s(2, 1)), 0.5 * (s(2, 0) + s(0, 2)), 1};
          for (std::size_t c = 0; c < width; ++c) sum[c] += w * entries[c];
        }
      }
    }
  });
  std::vector<double> result(nodes.size(), 0);
  points.gather(parts.data(), width, [&](std::size_t node, const double* sum) {
    if (!(sum[6] > 0)) return;
    const double xy = sum[0] - sum[1], yz = sum[1] - sum[2], zx = sum[2] - sum[0];
    result[node] = std::sqrt(0.5 * (xy * xy + yz * yz + zx * zx) + 3 * (sum[3] * sum[3] + sum[4] * sum[4] + sum[5] * sum[5])) / sum[6];
  });
  return result;
}

}  // namespace geo
