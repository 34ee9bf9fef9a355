// Groups of pieces: small ones that join their neighbours, and a hierarchy of clusters for engines
// that break a model level by level.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kerf/complex.h"
#include "kerf/pieces.h"

namespace geo {

/// The group of each piece, so that no group is smaller than `least` (model units³) if it has a
/// bond. The smallest group below `least` joins the neighbour with which it shares the greatest
/// area, again and again. A group has the number of its lowest piece. `volume`: per piece. Ties:
/// the lowest number. Throws InputError for a bond of a piece that is not there.
std::vector<std::uint32_t> join_small_pieces(std::span<const double> volume, std::span<const Bond> bonds, double least);

/// Removes the crack faces between different pieces of one group, so that each group becomes one
/// piece. Cracks inside a piece stay. `group`: per piece, any number. `pieces` are those of the
/// complex as it is. Throws InputError where `group` has another length than there are pieces.
CrackDelta heal(Complex& complex, const Pieces& pieces, std::span<const std::uint32_t> group);

/// A level of a hierarchy: clusters of pieces that bonds hold together.
struct ClusterLevel {
  std::vector<std::uint32_t> of;  ///< the cluster of each cluster one level below; on the first level, of each piece
  std::vector<double> volume;     ///< per cluster, model units³; descending
  /// Between clusters, ordered by (a, b). Areas and sections are sums of those of the bonds between
  /// their pieces; normals and centroids are means weighted by area.
  std::vector<Bond> bonds;
};

/// A hierarchy of `levels` levels, the pieces included: levels − 1 levels of clusters, from fine to
/// coarse. The last has one cluster for each set of pieces that bonds connect. The numbers of
/// clusters in between form a geometric sequence.
///
/// From one level to the next the smallest cluster joins a neighbour, again and again: that with
/// the greatest ratio of shared area to the square root of its volume. So clusters are compact and
/// of similar volumes. Ties: the cluster with the lowest piece. `volume`: per piece. Throws
/// InputError for a bond of a piece that is not there, or without levels.
std::vector<ClusterLevel> make_hierarchy(std::span<const double> volume, std::span<const Bond> bonds,
                                         std::size_t levels);

}  // namespace geo
