// Adaptive sampling of a solid into nodes: octree graded 2:1 towards the surface (§ 3.1, 6.4; Pauly et al. 2005).
#pragma once

#include <cstdint>

#include "base/progress.h"
#include "sampling/node_set.h"
#include "surface/triangle_mesh.h"

namespace geo {

struct SampleOptions {
  double spacing = 0;      ///< finest cell, model units; 0: 3 % of the diagonal, or what `count` asks for
  std::size_t count = 0;   ///< wanted number of nodes; 0: by spacing. Reached within a few per cent by bisection
  int levels = 2;          ///< resolution levels, each twice as coarse as the one before; ≥ 1
  double jitter = 0.15;    ///< random displacement of a node, as a fraction of its cell
  double support = 1.8;    ///< support radius over cell size, enlarged until enough nodes are within it
  std::uint64_t seed = 1;
};

/// Nodes inside a closed surface (check.h's require_solid holds). Inside and depth come from a signed distance field
/// (OpenVDB), the last word from exact ray parity. Deterministic for a seed and for any number of threads. Throws
/// InputError when the spacing is so large that no node fits inside.
NodeSet sample_nodes(const TriangleMesh& solid, const SampleOptions& options, const Progress& progress = {});

}  // namespace geo
