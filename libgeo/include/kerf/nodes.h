// Simulation nodes (§ 3.1): positions in material coordinates, and the adaptive sampling that makes
// them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kerf/mesh.h"
#include "kerf/progress.h"
#include "kerf/vec.h"

namespace geo {

/// Parallel arrays with one entry a node: in Morton order as sampled, nodes inserted later at the
/// end. Lengths are in model units.
struct NodeSet {
  std::vector<Vec3> position;   ///< strictly inside the material
  std::vector<double> radius;   ///< support radius r_i
  std::vector<double> spacing;  ///< edge length of the node's octree cell
  std::vector<double> volume;   ///< material that the node owns; the sum is the body's volume

  /// Number of nodes.
  std::size_t size() const { return position.size(); }
};

// ---- Sampling of a solid: an octree refined towards the surface, neighbouring leaves 2:1 at most
// (§ 3.1, 6.4; Pauly et al. 2005).

/// Position of a node in its leaf.
enum class NodePattern {
  jitter,  ///< the middle, displaced at random
  blue,    ///< moved apart from its neighbours (blue noise)
  grid     ///< the middle
};

/// Options of sample_nodes().
struct SampleOptions {
  double spacing = 0;      ///< cells at the surface, model units; 0: 3 % of the diagonal, or what `count` requires
  std::size_t count = 0;   ///< wanted number of nodes, met exactly, or within 2 % for symmetric models; 0: by spacing
  int levels = 2;          ///< levels of resolution, each twice as coarse as the one before; 1 to 10
  double jitter = 0.15;    ///< random displacement as a fraction of the cell, up to 0.5; for NodePattern::jitter
  double support = 1.8;    ///< support radius in spacings, enlarged until enough nodes are within it
  std::uint64_t seed = 1;  ///< of the displacements
  NodePattern pattern = NodePattern::jitter;  ///< position of a node in its leaf
  int across = 0;  ///< nodes wanted across thin material: cells there are up to 32 times finer, with `count`
                   ///< as far as it affords; 0: as fine as elsewhere
};

/// Findings of a sampling.
struct SampleReport {
  double spacing = 0;                 ///< cells at the surface, model units
  double thinnest = 0;                ///< the thinnest wall with less than `across` regular cells; 0: none
  Vec3 thinnest_at = Vec3::Zero();    ///< a point in that wall
  double unresolved = 0;              ///< the thinnest wall with less than `across` of the finest cells; 0: none
  Vec3 unresolved_at = Vec3::Zero();  ///< a point in that wall
  double octree_seconds = 0;          ///< dividing cells
  double node_seconds = 0;            ///< placing nodes
  double support_seconds = 0;         ///< support radii
};

/// Samples a closed surface with nodes inside it. Inside is exact (ray parity), also in slits and
/// walls much thinner than a cell. Deterministic for a seed, whatever the number of threads.
/// \param solid  a valid model, as require_solid() in kerf/check.h checks; it is not checked again
/// \param options  lengths are in model units
/// \param report  where given, receives what the sampling found
/// \throws InputError for options out of range, and for a spacing so large that no node fits inside
/// \throws Interrupted where `progress` asks for it
NodeSet sample_nodes(const TriangleMesh& solid, const SampleOptions& options, const Progress& progress = {},
                     SampleReport* report = nullptr);

/// Walls with fewer nodes across than asked for.
struct ThinMaterial {
  double share = 0;        ///< of the surface that such walls have, 0 to 1
  double thickness = 0;    ///< half of their surface belongs to walls that are thinner; 0: none
  double spacing = 0;      ///< of the nodes there, model units
  Vec3 at = Vec3::Zero();  ///< a point in a wall of that thickness
  double enough = 0;       ///< the spacing with which walls of that thickness have enough nodes
};

/// Finds the walls of a closed surface with few node spacings between their two sides. With less
/// than two, a wall cannot bend: its strain varies across it, and one layer of nodes has the mean
/// of both sides alone. Looks at 4,096 triangles at most, evenly among all.
/// \param across  walls with fewer spacings than this are thin
ThinMaterial find_thin_material(const TriangleMesh& solid, const NodeSet& nodes, double across = 2);

}  // namespace geo
