// From points to nodes and back, with the kernel over a point's influence as weight. Only blocks
// with a node that changes are read, so that the cost follows the cut.
#include "mechanics/discretisation/point_transfer.h"

#include <algorithm>

#include "mechanics/discretisation/kernel.h"

namespace geo {
namespace {

// Calls visit(node, weight) for the nodes of a point.
template <class Visit>
void each_weight(const PointBlock& block, std::size_t point, const std::vector<Vec3>& position, const Visit& visit) {
  const MaterialPoint& p = block.points[point];
  for (auto e = block.entry_begin[point]; e < block.entry_begin[point + 1]; ++e) {
    const std::uint32_t node = block.nodes[block.entry_node[e]];
    visit(node, kernel((position[node] - p.position).norm() / p.influence_radius, 1));
  }
}

}  // namespace

PointTransfer::PointTransfer(const MaterialPoints& points, const std::vector<Vec3>& position,
                             std::span<const char> changed, const std::vector<Mat3>& field)
    : field_(field) {
  if (field.empty()) return;
  sum_.assign(position.size(), Mat3::Zero());
  weight_.assign(position.size(), 0);
  for (std::size_t b = 0; b < points.blocks.size(); ++b) {
    const PointBlock& block = points.blocks[b];
    if (std::none_of(block.nodes.begin(), block.nodes.end(), [&](auto node) { return changed[node] != 0; })) continue;
    for (std::size_t i = 0; i < block.points.size(); ++i)
      each_weight(block, i, position, [&](std::uint32_t node, double weight) {
        sum_[node] += weight * block.points[i].volume * field[points.first_point(b) + i];
        weight_[node] += weight * block.points[i].volume;
      });
  }
}

std::vector<Mat3> PointTransfer::after(const MaterialPoints& points, const std::vector<Vec3>& position,
                                       std::span<const std::uint32_t> old_point, const Mat3& elsewhere) const {
  std::vector<Mat3> result(field_.empty() ? 0 : points.size(), elsewhere);
  for (std::size_t b = 0; b < points.blocks.size() && !result.empty(); ++b)
    for (std::size_t i = 0; i < points.blocks[b].points.size(); ++i) {
      const std::size_t now = points.first_point(b) + i;
      if (old_point[now] != ~0u) {
        result[now] = field_[old_point[now]];
        continue;
      }
      Mat3 sum = Mat3::Zero();
      double weights = 0;
      each_weight(points.blocks[b], i, position, [&](std::uint32_t node, double weight) {
        if (!(weight_[node] > 0)) return;
        sum += weight / weight_[node] * sum_[node];
        weights += weight;
      });
      if (weights > 0) result[now] = sum / weights;
    }
  return result;
}

}  // namespace geo
