// Which glued bonds break under their loads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/glue.h"
#include "kerf/scene.h"
#include "simulation/bond_loads.h"

namespace geo {

/// Decides which bonds of a body break. Refers to no body: bonds are given anew in each call, and
/// are always those of the constructor, apart from what has broken.
class BondBreaking {
 public:
  /// Finds the neighbours of each bond: those that share an edge of their walls.
  explicit BondBreaking(const GluedBonds& glued);

  /// The traction that a bond carries, Pa: its strength. Where a neighbour has broken and the bond
  /// has a toughness, at most the mean stress ahead of a crack tip at which the stress intensity
  /// reaches that, over the width √A of the wall (stress_of_toughness()).
  double limit(const GluedBonds& glued, std::uint32_t bond) const;

  /// The traction of each bond over its limit; 0 where it is broken. `friction`: see
  /// BondLoad::effective().
  std::vector<double> ratios(const GluedBonds& glued, std::span<const BondLoad> loads, double friction) const;

  /// The bonds that break now, the most loaded one first: those whose traction exceeds their limit,
  /// and by more than that of each neighbour. A neighbour may break later, when the stress around
  /// the opened wall has fallen. `ratio`: ratios().
  std::vector<std::uint32_t> overloaded(std::span<const double> ratio) const;

  /// The bonds beside broken ones that are no more than ligaments, ascending. Groups of cells are
  /// joined where the area of the bonds between them is at least `least`, again and again; bonds
  /// between the groups that remain are ligaments.
  std::vector<std::uint32_t> ligaments(const GluedBonds& glued, double least) const;

 private:
  bool is_at_crack(const GluedBonds& glued, std::uint32_t bond) const;

  std::vector<std::vector<std::uint32_t>> neighbors_;  // by bond, ascending
};

/// Gives the cells of the bonds from `first` on numbers that no earlier bond has.
void number_cells(GluedBonds& glued, std::size_t first);

/// Sets strength and toughness of bonds from `first` on: those of `glue` times strength_factor() at
/// the centroid of each bond. `diagonal`: see there; `body`: whose bonds they are.
void set_strength(GluedBonds& glued, std::size_t first, const Strength& glue, std::uint64_t seed, double diagonal,
                  std::uint32_t body);

}  // namespace geo
