// Where to look for what faces cut (§ 6.3): nodes and guides that are near enough.
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

/// The stretch that some faces cover along one's normal, from `origin`, and some more: a segment
/// beyond it touches none.
struct Slab {
  /// Of the faces in `rows`; heights are asked of points at most `reach` from the origin along each
  /// axis.
  Slab(std::span<const std::array<Vec3, 3>> faces, std::span<const std::uint32_t> rows, const Vec3& origin,
       double reach);
  double height(const Vec3& x) const {
    return ((x.x() - origin.x()) * normal.x() + (x.y() - origin.y()) * normal.y()) + (x.z() - origin.z()) * normal.z();
  }
  /// False only for what is farther from all of the faces than `distance`.
  bool within(double height, double distance) const {
    return height >= from - distance * length && height <= to + distance * length;
  }
  Vec3 origin, normal = Vec3::Zero();
  double from = std::numeric_limits<double>::infinity(), to = -from;
  double length = 0;  ///< of the normal, or a trifle more
};

/// One end at least of everything that the faces cut.
struct Near {
  std::vector<std::uint32_t> ids, slabs;  ///< nodes and guides, and for each one of `slab`
  std::vector<Slab> slab;                 ///< of all faces within reach
};

/// Looks among guides and nodes before `first_new`. `tree`: over the faces. `grid` holds all nodes.
Near find_cut_candidates(const NodeSet& nodes, const GraphStorage& graph, const NodeGrid& grid, NodeId first_new,
                         std::span<const std::array<Vec3, 3>> faces, const TriangleBvh& tree);

}  // namespace geo
