// From material points to nodes: what both pictures and fracture ask of stress.
#pragma once

#include <array>
#include <functional>

#include "mechanics/solid.h"

namespace geo {

/// Sums of six numbers of a stress (xx, yy, zz, xy, yz, zx) over points, each times a weight, and the sum of the weights.
using StressSums = std::array<double, 7>;

/// The six numbers of a point, from its material, its deformation gradient and that of what is elastic in it; false: it cannot tell.
using PointStress = std::function<bool(const Material& material, const Mat3& all, const Mat3& elastic, std::array<double, 6>& out)>;

/// For each node the sums over the material points whose shape functions have it in them, which see it, weighed by volume and
/// the kernel over the node's support. Rigid points count for nothing. The same for any number of threads.
std::vector<StressSums> node_sums(const Solid& solid, const NodeSet& nodes, const State& state, const PointStress& stress);

}  // namespace geo
