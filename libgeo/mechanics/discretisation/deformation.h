// The displacement field between nodes (§ 3.2, Eq. 1).
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "kerf/nodes.h"
#include "kerf/vec.h"
#include "mechanics/discretisation/kernel.h"
#include "mechanics/discretisation/nodal_gradients.h"

namespace geo {

/// Eq. 1: the displacement at x, material coordinates, a blend of the nodes' affine motions u_i +
/// ∇u_i (x − x_i), with rotations in place of what gradients would amplify (most_amplified).
/// `nodes`: ids with their distance to x, not empty. `gradient`: of the displacements u. If no
/// kernel reaches x, the first node's motion.
Vec3 displacement_at(const Vec3& x, std::span<const std::pair<NodeId, double>> nodes, const NodeSet& set,
                     const std::vector<Vec3>& u, const LazyNodalGradients& gradient);

}  // namespace geo
