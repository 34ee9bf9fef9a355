// join_small_pieces(), heal() and make_hierarchy() of kerf/hierarchy.h.
//
// Groups of pieces merge in a graph whose edges carry shared areas. A queue, ordered by volume and
// number, holds the groups that may still join a neighbour.
#include "kerf/hierarchy.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <string>

#include "base/union_find.h"
#include "kerf/error.h"

namespace geo {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

void require_pieces(std::size_t pieces, std::span<const Bond> bonds) {
  for (const Bond& bond : bonds)
    if (bond.a >= pieces || bond.b >= pieces || bond.a == bond.b)
      throw InputError("a bond joins pieces " + std::to_string(bond.a) + " and " + std::to_string(bond.b) + " of " +
                       std::to_string(pieces) + "; give the bonds of these pieces");
}

// Groups that merge. A group has the number of its lowest piece.
class Groups {
 public:
  Groups(std::span<const double> volume, std::span<const Bond> bonds)
      : volume_(volume.begin(), volume.end()), shared_(volume.size()), sets_(volume.size()), count_(volume.size()) {
    require_pieces(volume.size(), bonds);
    for (const Bond& bond : bonds) {
      shared_[bond.a][bond.b] += bond.area;
      shared_[bond.b][bond.a] += bond.area;
    }
    for (std::uint32_t g = 0; g < volume.size(); ++g)
      if (!shared_[g].empty()) queue_.insert({volume_[g], g});
  }

  std::size_t count() const { return count_; }
  /// The smallest group that has a neighbour; null without one.
  const std::pair<double, std::uint32_t>* smallest() const { return queue_.empty() ? nullptr : &*queue_.begin(); }
  std::vector<std::uint32_t> of_pieces() {
    std::vector<std::uint32_t> group(volume_.size());
    for (std::uint32_t p = 0; p < group.size(); ++p) group[p] = sets_.find(p);
    return group;
  }
  /// Joins the smallest group with the neighbour of the greatest merit(area, neighbour's volume).
  void join_smallest(const auto& merit) {
    const std::uint32_t g = queue_.begin()->second;
    std::uint32_t best = shared_[g].begin()->first;
    double most = merit(shared_[g].begin()->second, volume_[best]);
    for (const auto& [other, area] : shared_[g])
      if (const double value = merit(area, volume_[other]); value > most) {
        best = other;
        most = value;
      }
    merge(std::min(g, best), std::max(g, best));
  }

 private:
  void merge(std::uint32_t kept, std::uint32_t gone) {
    queue_.erase({volume_[kept], kept});
    queue_.erase({volume_[gone], gone});
    for (const auto& [other, area] : shared_[gone]) {
      shared_[other].erase(gone);
      if (other == kept) continue;
      shared_[kept][other] += area;
      shared_[other][kept] += area;
    }
    shared_[gone].clear();
    volume_[kept] += volume_[gone];
    sets_.unite(kept, gone);
    --count_;
    if (!shared_[kept].empty()) queue_.insert({volume_[kept], kept});
  }

  std::vector<double> volume_;
  std::vector<std::map<std::uint32_t, double>> shared_;  // areas, by neighbour
  std::set<std::pair<double, std::uint32_t>> queue_;
  UnionFind sets_;
  std::size_t count_;
};

// Bonds between the clusters of the pieces, as sums.
std::vector<Bond> summed(std::span<const Bond> bonds, const std::vector<std::uint32_t>& cluster) {
  std::map<Pair, Bond> sums;
  for (const Bond& bond : bonds) {
    const auto a = cluster[bond.a], b = cluster[bond.b];
    if (a == b) continue;
    Bond& sum = sums[std::minmax(a, b)];
    sum.area += bond.area;
    sum.section += bond.section;
    sum.centroid += bond.area * bond.centroid;
    sum.normal += (a < b ? bond.area : -bond.area) * bond.normal;
  }
  std::vector<Bond> result;
  for (auto& [pair, sum] : sums) {
    sum.a = pair.first;
    sum.b = pair.second;
    if (sum.area > 0) sum.centroid /= sum.area;
    sum.normal = sum.normal.norm() > 0 ? Vec3(sum.normal.normalized()) : Vec3(Vec3::Zero());
    result.push_back(sum);
  }
  return result;
}

// Numbers clusters in descending order of volume; returns the cluster of each piece. `group`: per
// piece, the lowest piece of its cluster.
std::vector<std::uint32_t> numbered(const std::vector<std::uint32_t>& group, std::span<const double> volume,
                                    std::vector<double>& sums) {
  std::vector<double> of_group(group.size(), 0);
  for (std::size_t p = 0; p < group.size(); ++p) of_group[group[p]] += volume[p];
  std::vector<std::uint32_t> order;
  for (std::uint32_t p = 0; p < group.size(); ++p)
    if (group[p] == p) order.push_back(p);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return of_group[a] > of_group[b]; });
  std::vector<std::uint32_t> number(group.size(), 0), cluster(group.size());
  sums.clear();
  for (std::uint32_t c = 0; c < order.size(); ++c) {
    number[order[c]] = c;
    sums.push_back(of_group[order[c]]);
  }
  for (std::size_t p = 0; p < group.size(); ++p) cluster[p] = number[group[p]];
  return cluster;
}

std::size_t component_count(std::size_t pieces, std::span<const Bond> bonds) {
  UnionFind joined(pieces);
  for (const Bond& bond : bonds) joined.unite(bond.a, bond.b);
  std::size_t count = 0;
  for (std::uint32_t p = 0; p < pieces; ++p) count += joined.find(p) == p;
  return count;
}

}  // namespace

std::vector<std::uint32_t> join_small_pieces(std::span<const double> volume, std::span<const Bond> bonds,
                                             double least) {
  Groups groups(volume, bonds);
  while (groups.smallest() && groups.smallest()->first < least)
    groups.join_smallest([](double area, double) { return area; });
  return groups.of_pieces();
}

CrackDelta heal(Complex& complex, const Pieces& pieces, std::span<const std::uint32_t> group) {
  if (group.size() != pieces.count)
    throw InputError("groups of " + std::to_string(group.size()) + " pieces, but there are " +
                     std::to_string(pieces.count) + "; give one for each piece");
  ComplexEdit edit;
  for (std::uint32_t f = 0; f < complex.face_count(); ++f) {
    if (!complex.alive(FaceId(f)) || complex.face(FaceId(f)).crack == 0) continue;
    const auto behind = static_cast<std::size_t>(pieces.of_side[f * 2]),
               before = static_cast<std::size_t>(pieces.of_side[f * 2 + 1]);
    if (behind != before && group[behind] == group[before]) edit.removed_faces.push_back(FaceId(f));
  }
  return complex.apply(edit);
}

std::vector<ClusterLevel> make_hierarchy(std::span<const double> volume, std::span<const Bond> bonds,
                                         std::size_t levels) {
  if (levels == 0) throw InputError("a hierarchy has at least one level, that of the pieces");
  Groups groups(volume, bonds);
  const double pieces = static_cast<double>(volume.size());
  const double components = static_cast<double>(component_count(volume.size(), bonds));
  std::vector<std::uint32_t> below(volume.size());  // the cluster of each piece, one level below
  std::iota(below.begin(), below.end(), 0u);
  std::vector<ClusterLevel> result;
  for (std::size_t level = 1; level < levels; ++level) {
    const double left = static_cast<double>(levels - 1 - level) / static_cast<double>(levels - 1);
    const auto wanted = static_cast<std::size_t>(std::lround(components * std::pow(pieces / components, left)));
    while (groups.count() > wanted && groups.smallest())
      groups.join_smallest([](double area, double size) { return area / std::sqrt(std::max(size, 0.0)); });
    ClusterLevel next;
    const auto cluster = numbered(groups.of_pieces(), volume, next.volume);
    next.of.resize(result.empty() ? volume.size() : result.back().volume.size());
    for (std::size_t p = 0; p < cluster.size(); ++p) next.of[below[p]] = cluster[p];
    next.bonds = summed(bonds, cluster);
    below = cluster;
    result.push_back(std::move(next));
  }
  return result;
}

}  // namespace geo
