// Simulation nodes (§ 3.1): positions in material coordinates and what sampling decided about each.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/mesh.h"
#include "kerf/progress.h"
#include "kerf/vec.h"

namespace geo {

/// Parallel arrays, one entry a node, in Morton order as sampled; nodes inserted later are appended.
struct NodeSet {
  std::vector<Vec3> position;   ///< strictly inside the material
  std::vector<double> radius;   ///< support radius r_i, model units
  std::vector<double> spacing;  ///< edge length of the octree cell the node stands for, model units
  std::vector<double> volume;   ///< material that the node owns, model units³; sums to the body's volume

  std::size_t size() const { return position.size(); }
};

// ---- Adaptive sampling of a solid into nodes: octree graded 2:1 towards the surface (§ 3.1, 6.4; Pauly et al. 2005).

/// Where a leaf's node stands: anywhere about its middle, pushed apart from its neighbours, or in the middle.
enum class NodePattern { jitter, blue, grid };

struct SampleOptions {
  double spacing = 0;  ///< cells at the surface, model units; 0: 3 % of the diagonal, or what `count` asks for
  std::size_t count =
      0;           ///< wanted number of nodes; 0: by spacing. Reached exactly, or within 2 % where symmetry forbids
  int levels = 2;  ///< resolution levels, each twice as coarse as the one before; 1 to 10
  double jitter = 0.15;  ///< random displacement of a node, as a fraction of its cell; up to 0.5; of pattern `jitter`
  double support = 1.8;  ///< support radius over the spacing around, enlarged until enough nodes are within it
  std::uint64_t seed = 1;
  NodePattern pattern = NodePattern::jitter;
  int across = 0;  ///< nodes wanted across thin material: cells there are up to 32 times finer, with `count` as far as
                   ///< it affords; 0: as fine as elsewhere
};

/// What a sampling found out.
struct SampleReport {
  double spacing = 0;   ///< cells at the surface, model units
  double thinnest = 0;  ///< the thinnest wall of less than `across` cells, before any was made finer; 0: none
  Vec3 thinnest_at = Vec3::Zero();
  double unresolved = 0;  ///< the thinnest wall that still has fewer; 0: none
  Vec3 unresolved_at = Vec3::Zero();
  double octree_seconds = 0, node_seconds = 0, support_seconds = 0;
};

/// Nodes inside a closed surface (check.h's require_solid holds). Inside is exact (ray parity), also in slits and walls
/// much thinner than a cell. Deterministic for a seed and for any number of threads. Throws InputError for options out
/// of range and when the spacing is so large that no node fits inside.
NodeSet sample_nodes(const TriangleMesh& solid, const SampleOptions& options, const Progress& progress = {},
                     SampleReport* report = nullptr);

}  // namespace geo
