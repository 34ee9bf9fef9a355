// Blue noise: nodes move apart within their leaves.
#pragma once

#include "kerf/nodes.h"
#include "kerf/progress.h"
#include "sampling/leaf_index.h"

namespace geo {

/// In a few steps, moves each node with `free` set away from nodes nearer than the spacing. It
/// stays in the inner three quarters of its leaf, which the surface must not cut. Node i is leaf i.
/// All nodes move at once, so the order does not matter.
void move_apart(NodeSet& nodes, const LeafIndex& leaves, const Lattice& lattice, const std::vector<char>& free,
                const Progress& progress);

}  // namespace geo
