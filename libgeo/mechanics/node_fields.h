// How the material about each node has moved, and its stress: for pictures.
#pragma once

#include "mechanics/solid.h"

namespace geo {

/// Displacement of the material at each node, by Eq. 1 from the node and its neighbours. A node's own displacement is a
/// coefficient of that field: where nodes are crowded, as beside cracks, it may be far from what they say together.
std::vector<Vec3> material_displacement(const Solid& solid, const NodeSet& nodes, const VisibilityGraph& graph, const State& state);

/// Von Mises' equivalent of the Cauchy stress, Pa, one a node: the mean over material points whose shape functions have the node
/// in them, which see it, weighed by volume and the kernel over the node's support. Plastic strain is taken off; viscosity
/// adds nothing. Zero where no such point can tell.
std::vector<double> von_mises_stress(const Solid& solid, const NodeSet& nodes, const State& state);

}  // namespace geo
