// Blue noise: nodes move apart within their leaves.
#pragma once

#include "kerf/nodes.h"
#include "kerf/progress.h"
#include "sampling/leaf_index.h"

namespace geo {

/// In a few steps, moves each node i with free[i] = 1 away from nodes nearer than the mean of both
/// spacings. The node stays in the inner 76 % of its leaf along each axis (1 − 2 keep_off). Node i
/// is leaf i; free[i] = 0 for leaves that the surface cuts. All nodes move at once, so the order
/// does not matter.
void move_apart(NodeSet& nodes, const LeafIndex& leaves, const Lattice& lattice, const std::vector<char>& free,
                const Progress& progress);

}  // namespace geo
