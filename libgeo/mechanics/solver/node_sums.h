// From material points to nodes: what both pictures and fracture ask of stress.
#pragma once

#include <array>
#include <functional>

#include "kerf/solid.h"

namespace geo {

/// Sums of six numbers of a stress (xx, yy, zz, xy, yz, zx) over points, each times a weight, and
/// the sum of the weights.
using StressSums = std::array<double, 7>;

/// The six numbers of a point, from its material, its deformation gradient and that of what is
/// elastic in it; false: it cannot tell.
using PointStress =
    std::function<bool(const Material& material, const Mat3& all, const Mat3& elastic, std::array<double, 6>& out)>;

/// The same of all points of a block, from ∇u at each: eight numbers a point, a multiple of eight
/// of them, zero at first: the six, 1 where the point can tell, and 0.
using BlockStress = std::function<void(std::size_t block, const PointMatrices<double>& gradient, float* own)>;

/// For each node the sums over the material points whose shape functions have it in them, which see
/// it, weighed by volume and the kernel over the node's support; sums and weights are in single
/// precision. Rigid points count for nothing. The same for any number of threads.
std::vector<StressSums> node_sums(const Solid& solid, const NodeSet& nodes, const State& state,
                                  const BlockStress& stress);
std::vector<StressSums> node_sums(const Solid& solid, const NodeSet& nodes, const State& state,
                                  const PointStress& stress);

}  // namespace geo
