// Which cells of an octree over a solid are divided (Pauly et al. 2005): those at the surface and in thin material,
// fewer with the depth, neighbours (corners included) differing by one level at most.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "kerf/progress.h"
#include "sampling/thickness.h"

namespace geo {

struct OctreeShape {
  Lattice lattice;
  int root = 0;     ///< level of the cell at the lattice's origin that holds the surface
  int top = 0;      ///< no leaf is coarser
  int regular = 0;  ///< level of leaves that the surface cuts; finer ones only where the material is thin
  int across = 0;   ///< leaves wanted across thin material; 0: none are made finer for it
};

/// By level, the Morton codes of the divided cells, ascending; only levels up to the top, above it all are.
using Divisions = std::vector<std::vector<std::uint64_t>>;

inline bool is_divided(const Divisions& divided, const Cell& c) {
  const auto& codes = divided[static_cast<std::size_t>(c.level)];
  return std::binary_search(codes.begin(), codes.end(), morton(c.corner));
}

/// The thinnest wall that is less than `across` regular cells thick, and the thinnest with fewer even of the finest.
struct ThinPlaces {
  Wall thinnest, unresolved;
};

/// A cell that the surface cuts is divided down to the regular level, another while its middle is less deep than the
/// cell is large, and any while thin material has too few cells across; then whatever the 2:1 rule asks for. Gives up,
/// returning nothing, when more than `most` cells are to be divided.
std::optional<Divisions> plan_octree(const RegionTree& tree, const OctreeShape& shape, std::size_t most,
                                     ThinPlaces& thin, const Progress& progress);

/// Adds to each level the cells that the 2:1 rule asks for.
void balance(Divisions& divided);

}  // namespace geo
