// The deformation of points between nodes (§ 3.2, Eq. 1), and its inverse.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "base/ids.h"
#include "sampling/node_grid.h"
#include "sampling/node_set.h"

namespace geo {

/// Eq. 1: the displacement at material point x, from nodes with their Euclidean distances to it. Not empty.
Vec3 displacement_at(const Vec3& x, std::span<const std::pair<NodeId, double>> nodes, const NodeSet& set,
                     const std::vector<Vec3>& u, const std::vector<Mat3>& gradient);

/// Maps world points back to material ones. Interior points: each node maps the point back by its own affine map, and
/// kernel weights in world coordinates blend them (§ 3.2). Points outside of every support take the nearest nodes, so
/// that a blade has a place before it enters and after it leaves.
class InverseMap {
 public:
  InverseMap(const NodeSet& set, const std::vector<Vec3>& u, const std::vector<Mat3>& gradient);
  Vec3 material(const Vec3& world) const;

 private:
  const NodeSet& set_;
  std::vector<Vec3> world_;
  std::vector<Mat3> back_;  // per node: (I + ∇u)⁻¹
  NodeGrid grid_;
};

}  // namespace geo
