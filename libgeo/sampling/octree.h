// The octree of the sampling (Pauly et al. 2005): cells are divided at the surface and in thin
// material, fewer with the depth. Neighbours, corners included, differ by one level at most.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "kerf/progress.h"
#include "sampling/thickness.h"

namespace geo {

/// Extent and levels of an octree.
struct OctreeShape {
  Lattice lattice;
  int root = 0;     ///< level of the cell at the lattice's origin that contains the surface
  int top = 0;      ///< no leaf is coarser
  int regular = 0;  ///< level of leaves that the surface cuts; finer ones only where the material is thin
  int across = 0;   ///< leaves wanted across thin material; 0: none are made finer for it
};

/// By level, the Morton codes of the divided cells, ascending; only levels up to `top`. All cells
/// above are divided.
using Divisions = std::vector<std::vector<std::uint64_t>>;

/// Is the cell divided?
inline bool is_divided(const Divisions& divided, const Cell& c) {
  const auto& codes = divided[static_cast<std::size_t>(c.level)];
  return std::binary_search(codes.begin(), codes.end(), morton(c.corner));
}

/// Thinnest: the thinnest wall with less than `across` regular cells across. Unresolved: the
/// thinnest wall that even the finest cells do not resolve.
struct ThinPlaces {
  Wall thinnest, unresolved;
};

/// Divides three kinds of cells: above the regular level, cut by the surface; above the regular
/// level, not cut, with their middle nearer to the surface than their edge is long; at any level,
/// with fewer than `across` cells across thin material. Then cells for the 2:1 rule. Empty if more
/// than `most` cells would be divided.
std::optional<Divisions> plan_octree(const RegionTree& tree, const OctreeShape& shape, std::size_t most,
                                     ThinPlaces& thin, const Progress& progress);

/// Adds to each level the cells that the 2:1 rule divides.
void balance(Divisions& divided);

}  // namespace geo
