// A bond is the unit that breaks, as in the assets that kerf-pieces exports: it breaks as a whole.
#include "simulation/bond_breaking.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/union_find.h"
#include "simulation/strength.h"

namespace geo {

BondBreaking::BondBreaking(const GluedBonds& glued) : neighbors_(glued.bonds.size()) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> at_edge;
  for (std::uint32_t b = 0; b < glued.bonds.size(); ++b)
    for (const Triangle& face : glued.bonds[b].faces)
      for (std::size_t k = 0; k < 3; ++k) {
        auto& bonds = at_edge[std::minmax(face[k], face[(k + 1) % 3])];
        if (bonds.empty() || bonds.back() != b) bonds.push_back(b);
      }
  for (const auto& [edge, bonds] : at_edge)
    for (const auto b : bonds)
      for (const auto o : bonds)
        if (o != b) neighbors_[b].push_back(o);
  for (auto& list : neighbors_) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
}

bool BondBreaking::is_at_crack(const GluedBonds& glued, std::uint32_t bond) const {
  return std::any_of(neighbors_[bond].begin(), neighbors_[bond].end(),
                     [&](std::uint32_t o) { return glued.bonds[o].broken; });
}

double BondBreaking::limit(const GluedBonds& glued, std::uint32_t bond) const {
  const GluedBond& own = glued.bonds[bond];
  if (own.toughness == 0 || !is_at_crack(glued, bond)) return own.strength;
  return std::min(own.strength, stress_of_toughness(own.toughness, std::sqrt(own.area)));
}

std::vector<double> BondBreaking::ratios(const GluedBonds& glued, std::span<const BondLoad> loads,
                                         double friction) const {
  std::vector<double> ratio(loads.size(), 0);
  for (std::uint32_t b = 0; b < loads.size(); ++b)
    if (!glued.bonds[b].broken) ratio[b] = loads[b].effective(friction) / limit(glued, b);
  return ratio;
}

std::vector<std::uint32_t> BondBreaking::overloaded(std::span<const double> ratio) const {
  // The lower bond comes first where ratios are equal.
  const auto is_before = [&](std::uint32_t a, std::uint32_t b) {
    return ratio[a] != ratio[b] ? ratio[a] > ratio[b] : a < b;
  };
  std::vector<std::uint32_t> result;
  for (std::uint32_t b = 0; b < ratio.size(); ++b)
    if (ratio[b] > 1 && std::none_of(neighbors_[b].begin(), neighbors_[b].end(),
                                     [&](std::uint32_t o) { return ratio[o] > 1 && is_before(o, b); }))
      result.push_back(b);
  std::sort(result.begin(), result.end(), is_before);
  return result;
}

std::vector<std::uint32_t> BondBreaking::ligaments(const GluedBonds& glued, double least) const {
  std::uint32_t cells = 0;
  for (const GluedBond& bond : glued.bonds) cells = std::max({cells, bond.a + 1, bond.b + 1});
  UnionFind groups(cells);
  const auto joins_groups = [&](const GluedBond& bond) {
    return !bond.broken && groups.find(bond.a) != groups.find(bond.b);
  };
  for (bool joined = true; joined;) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> area;
    for (const GluedBond& bond : glued.bonds)
      if (joins_groups(bond)) area[std::minmax(groups.find(bond.a), groups.find(bond.b))] += bond.area;
    joined = false;
    for (const auto& [pair, between] : area) {
      if (between < least) continue;
      groups.unite(pair.first, pair.second);
      joined = true;
    }
  }
  std::vector<std::uint32_t> result;
  for (std::uint32_t b = 0; b < glued.bonds.size(); ++b)
    if (joins_groups(glued.bonds[b]) && is_at_crack(glued, b)) result.push_back(b);
  return result;
}

void number_cells(GluedBonds& glued, std::size_t first) {
  std::uint32_t next = 0;
  for (std::size_t b = 0; b < first; ++b) next = std::max({next, glued.bonds[b].a + 1, glued.bonds[b].b + 1});
  for (std::size_t b = first; b < glued.bonds.size(); ++b) {
    glued.bonds[b].a += next;
    glued.bonds[b].b += next;
  }
}

void set_strength(GluedBonds& glued, std::size_t first, const Strength& glue, std::uint64_t seed, double diagonal,
                  std::uint32_t body) {
  for (std::size_t b = first; b < glued.bonds.size(); ++b) {
    GluedBond& bond = glued.bonds[b];
    const double factor = strength_factor(glue, seed, diagonal, bond.centroid);
    bond.body = body;
    bond.strength = factor * glue.strength;
    bond.toughness = factor * glue.toughness;
  }
}

}  // namespace geo
