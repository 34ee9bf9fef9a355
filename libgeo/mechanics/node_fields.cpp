#include "mechanics/node_fields.h"

#include <cmath>

#include "base/parallel.h"
#include "mechanics/deformation.h"
#include "mechanics/node_sums.h"

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
  const auto sums = node_sums(solid, nodes, state, [](const Material& material, const Mat3&, const Mat3& elastic, std::array<double, 6>& out) {
    const double j = elastic.determinant();
    if (!(j > 0)) return false;
    const Mat3 s = stress(material, elastic) * elastic.transpose() / j;
    out = {s(0, 0), s(1, 1), s(2, 2), 0.5 * (s(0, 1) + s(1, 0)), 0.5 * (s(1, 2) + s(2, 1)), 0.5 * (s(2, 0) + s(0, 2))};
    return true;
  });
  std::vector<double> result(nodes.size(), 0);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const StressSums& sum = sums[i];
    if (!(sum[6] > 0)) continue;
    const double xy = sum[0] - sum[1], yz = sum[1] - sum[2], zx = sum[2] - sum[0];
    result[i] = std::sqrt(0.5 * (xy * xy + yz * yz + zx * zx) + 3 * (sum[3] * sum[3] + sum[4] * sum[4] + sum[5] * sum[5])) / sum[6];
  }
  return result;
}

}  // namespace geo
