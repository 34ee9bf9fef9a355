// The deformation of points between nodes (§ 3.2, Eq. 1).
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "base/ids.h"
#include "sampling/node_set.h"

namespace geo {

/// Eq. 1: the displacement at material point x, from nodes with their Euclidean distances to it. Not empty.
Vec3 displacement_at(const Vec3& x, std::span<const std::pair<NodeId, double>> nodes, const NodeSet& set,
                     const std::vector<Vec3>& u, const std::vector<Mat3>& gradient);

}  // namespace geo
