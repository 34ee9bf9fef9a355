#include "mechanics/node_fields.h"

#include <cmath>

#include "base/parallel.h"
#include "mechanics/node_sums.h"

namespace geo {

std::vector<Vec3> material_displacement(const Solid& solid, const NodeSet& nodes, const VisibilityGraph& graph, const State& state) {
  // Eq. 1, of one affine map a node about a common middle: those of all neighbours are summed before they act.
  using Affine = Eigen::Matrix<double, 3, 4>;
  const auto gradient = solid.gradients(state.displacement);
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : nodes.position) middle += x / double(nodes.size());
  std::vector<Affine> map(nodes.size());
  std::vector<Vec3> moved(nodes.size());
  parallel_for(nodes.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) map[i] << gradient[i], state.displacement[i] - gradient[i] * (nodes.position[i] - middle);
  });
  parallel_for(nodes.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& x = nodes.position[i];
      double total = 0;
      Affine sum = Affine::Zero();
      const auto add = [&](std::size_t j) {
        const double far = (x - nodes.position[j]).squaredNorm() / (nodes.radius[j] * nodes.radius[j]);
        if (!(far < 1)) return;
        const double w = (1 - far) * (1 - far) * (1 - far);
        total += w, sum += w * map[j];
      };
      add(i);
      for (const auto& n : graph.neighbors(nodes, NodeId(i))) add(n.to.index());
      moved[i] = (sum.leftCols<3>() * (x - middle) + sum.col(3)) / total;
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
