// Blue noise: nodes pushed apart within their leaves.
#pragma once

#include "kerf/nodes.h"
#include "kerf/progress.h"
#include "sampling/leaf_index.h"

namespace geo {

/// A few steps in which each node with `free` set moves away from those nearer than the spacing, but stays in the inner
/// three quarters of its leaf, which must hold no surface. Row i of the nodes is leaf i. All nodes move at once, so
/// that the order does not matter.
void push_apart(NodeSet& nodes, const LeafIndex& leaves, const Lattice& lattice, const std::vector<char>& free,
                const Progress& progress);

}  // namespace geo
