// Nodes and guides so near to new faces that the faces may cut their edges (§ 6.3).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "geometry/bvh.h"
#include "graph/graph_storage.h"
#include "sampling/node_grid.h"

namespace geo {

/// The slab between two parallel planes that contains some faces: a segment whose ends are beyond
/// the same plane touches none of them. Heights are measured from `origin` along the normal of the
/// largest face, in units of the normal's length.
struct Slab {
  /// The slab of faces[f] for the f in `indices`. Valid for points at most `reach` from the origin
  /// along each axis.
  Slab(std::span<const std::array<Vec3, 3>> faces, std::span<const std::uint32_t> indices, const Vec3& origin,
       double reach);
  /// Height of a point.
  double height(const Vec3& x) const {
    return ((x.x() - origin.x()) * normal.x() + (x.y() - origin.y()) * normal.y()) + (x.z() - origin.z()) * normal.z();
  }
  /// False only for heights of points farther from all faces than `distance`.
  bool within(double height, double distance) const {
    return height >= from - distance * length && height <= to + distance * length;
  }
  Vec3 origin, normal = Vec3::Zero();
  double from = std::numeric_limits<double>::infinity(), to = -from;  ///< heights of the planes, rounding included
  double length = 0;                                                  ///< of the normal, rounded up
};

/// At least one end of each pair that the faces cut, with some others.
struct CutCandidates {
  std::vector<std::uint32_t> ids;    ///< nodes and guides
  std::vector<std::uint32_t> slabs;  ///< for each id an index into `slab`
  std::vector<Slab> slab;            ///< each contains all faces near the ids that refer to it
};

/// Searches guides and the nodes before `first_new`. `tree` is over `faces`, `grid` over all nodes.
CutCandidates find_cut_candidates(const NodeSet& nodes, const GraphStorage& graph, const NodeGrid& grid,
                                  NodeId first_new, std::span<const std::array<Vec3, 3>> faces,
                                  const TriangleBvh& tree);

}  // namespace geo
