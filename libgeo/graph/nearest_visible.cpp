// Nodes are grouped by bisection of their bounding box until a group is as wide as a support
// radius. A group shares one BVH of the triangles near it, against which its candidates are tested
// exactly.
#include "graph/nearest_visible.h"

#include <algorithm>
#include <numeric>

#include "geometry/bvh.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

using Group = std::span<std::uint32_t>;  // indices into `ids`

// Divides nodes into groups at most a support radius wide, so that nodes near one of a group are
// mostly near the others.
void divide(const NodeSet& nodes, std::span<const std::uint32_t> ids, Group all, std::vector<Group>& groups) {
  Box3 box;
  double support = 0;
  for (const auto index : all) {
    box.add(nodes.position[ids[index]]);
    support = std::max(support, nodes.radius[ids[index]]);
  }
  Eigen::Index axis = 0;
  const Vec3 size = box.hi - box.lo, middle = box.center();
  const auto second =
      size.maxCoeff(&axis) <= support ? all.begin() : std::partition(all.begin(), all.end(), [&](auto index) {
        return nodes.position[ids[index]][axis] < middle[axis];
      });
  if (second == all.begin() || second == all.end()) {
    groups.push_back(all);
    return;
  }
  const auto count = static_cast<std::size_t>(second - all.begin());
  divide(nodes, ids, all.first(count), groups);
  divide(nodes, ids, all.subspan(count), groups);
}

}  // namespace

std::vector<std::vector<std::uint32_t>> nearest_visible(
    const NodeSet& nodes, const NodeGrid& grid, std::span<const std::uint32_t> ids, int k,
    const std::function<void(const Box3&, std::vector<std::array<Vec3, 3>>&)>& obstacles_near,
    const Progress& progress) {
  const auto& x = nodes.position;
  const auto wanted = static_cast<std::size_t>(k);
  std::vector<std::vector<std::uint32_t>> visible(ids.size());
  std::vector<std::uint32_t> indices(ids.size());
  std::iota(indices.begin(), indices.end(), 0u);
  std::vector<Group> groups;
  if (!ids.empty()) divide(nodes, ids, indices, groups);
  const auto search = [&](Group group) {
    std::vector<std::vector<std::uint32_t>> candidates;
    Box3 box;  // of all segments
    for (const auto index : group) {
      candidates.push_back(grid.nearest(x, x[ids[index]], 3 * wanted, ids[index], [](auto) { return true; }));
      box.add(x[ids[index]]);
      for (const auto j : candidates.back()) box.add(x[j]);
    }
    std::vector<std::array<Vec3, 3>> triangles;
    obstacles_near(box, triangles);
    const TriangleBvh tree(triangles);
    std::vector<Vec3> ends;
    std::vector<std::uint8_t> blocked;
    for (std::size_t g = 0; g < group.size(); ++g) {
      auto& found = visible[group[g]];
      // k at a time, since most are visible as a rule.
      for (std::span<const std::uint32_t> rest = candidates[g]; !rest.empty() && found.size() < wanted;) {
        const auto some = rest.first(std::min(wanted, rest.size()));
        rest = rest.subspan(some.size());
        ends.clear();
        for (const auto j : some) ends.push_back(x[j]);
        blocked.resize(some.size());
        tree.blocks(x[ids[group[g]]], ends, blocked.data());
        for (std::size_t e = 0; e < some.size() && found.size() < wanted; ++e)
          if (!blocked[e]) found.push_back(some[e]);
      }
    }
  };
  // Groups between two reports of progress.
  constexpr std::size_t part = 256;
  for (std::size_t first = 0; first < groups.size(); first += part) {
    report(progress, "new edges", first, groups.size());
    parallel_for(std::min(part, groups.size() - first), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t g = begin; g < end; ++g) search(groups[first + g]);
    });
  }
  return visible;
}

}  // namespace geo
