// The share of gradients, and so of rotations, is the same for all nodes of a blend.
#include "mechanics/discretisation/deformation.h"

namespace geo {

Vec3 displacement_at(const Vec3& x, std::span<const std::pair<NodeId, double>> nodes, const NodeSet& set,
                     const std::vector<Vec3>& u, const LazyNodalGradients& gradient) {
  double total = 0, amplified = 0;
  Vec3 sum = Vec3::Zero();
  const auto add = [&](NodeId id, double w) {
    const std::size_t i = id.index();
    const Vec3 arm = x - set.position[i];
    total += w;
    amplified += w * gradient.amplification(i, arm);
    sum += w * (u[i] + gradient[i] * arm);
  };
  const auto weight = [&](const std::pair<NodeId, double>& n) {
    return kernel(n.second / set.radius[n.first.index()], 1.0);
  };
  for (const auto& n : nodes)
    if (const double w = weight(n); w > 0) add(n.first, w);
  const bool is_reached = total > 0;
  if (!is_reached) add(nodes[0].first, 1);
  const double share = gradient_share(amplified / total);
  if (share == 1) return sum / total;
  Vec3 rotated = Vec3::Zero();
  const auto add_rotated = [&](NodeId id, double w) {
    const std::size_t i = id.index();
    rotated += w * (u[i] + (gradient.rotation(i) - Mat3::Identity()) * (x - set.position[i]));
  };
  if (!is_reached) add_rotated(nodes[0].first, 1);
  for (const auto& n : nodes)
    if (const double w = weight(n); w > 0) add_rotated(n.first, w);
  return share * (sum / total) + (1 - share) * (rotated / total);
}

}  // namespace geo
