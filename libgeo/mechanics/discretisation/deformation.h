// The displacement field between nodes (§ 3.2, Eq. 1).
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "kerf/nodes.h"
#include "kerf/vec.h"
#include "mechanics/discretisation/kernel.h"

namespace geo {

/// Eq. 1: the displacement at x, material coordinates, a blend of the nodes' affine motions u_i +
/// ∇u_i (x − x_i). `nodes`: ids with their distance to x, not empty. `gradient[i]`: ∇u at node i.
/// If no kernel reaches x, the first node's motion.
template <class Gradients>
Vec3 displacement_at(const Vec3& x, std::span<const std::pair<NodeId, double>> nodes, const NodeSet& set,
                     const std::vector<Vec3>& u, const Gradients& gradient) {
  double total = 0;
  Vec3 sum = Vec3::Zero();
  for (const auto& [id, distance] : nodes) {
    const std::size_t i = id.index();
    const double w = kernel(distance / set.radius[i], 1.0);
    total += w;
    sum += w * (u[i] + gradient[i] * (x - set.position[i]));
  }
  if (total > 0) return sum / total;
  const std::size_t i = nodes[0].first.index();
  return u[i] + gradient[i] * (x - set.position[i]);
}

}  // namespace geo
