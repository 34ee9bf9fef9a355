#include "graph/nearest.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "graph/nearest_internal.h"

namespace geo {

void visit_nearest(const NodeTree& tree, int k, const std::function<void(NodeId, std::span<const NodeId>)>& take) {
  if (k < 0) throw InputError("nearest nodes: k is " + std::to_string(k) + ", give zero or more");
  if (tree.size() == 0) return;
  // Nodes that search together: as many as make up for gathering candidates, as few as have most candidates in common.
  constexpr std::uint32_t company = 48;
  const auto cells = tree.cells();
  std::vector<std::uint32_t> groups;
  for (std::uint32_t c = 0; c < cells.size(); ++c)
    if ((cells[c].leaf() || cells[c].count() <= company) && (c == 0 || cells[cells[c].parent].count() > company)) groups.push_back(c);
  // Along the Morton curve, so that each group can learn from the one before how far to look.
  std::sort(groups.begin(), groups.end(), [&](auto a, auto b) { return cells[a].begin < cells[b].begin; });
  parallel_for(groups.size(), 16, [&](std::size_t begin, std::size_t end) {
    nearest_of_groups(tree, std::span(groups).subspan(begin, end - begin), static_cast<std::uint32_t>(k), take);
  });
}

std::vector<NodeId> nearest_nodes(const NodeTree& tree, int k) {
  std::vector<NodeId> rows(tree.size() * static_cast<std::size_t>(std::max(k, 0)));
  visit_nearest(tree, k, [&](NodeId i, std::span<const NodeId> row) {
    std::copy(row.begin(), row.end(), rows.begin() + static_cast<std::ptrdiff_t>(i.index() * static_cast<std::size_t>(k)));
  });
  return rows;
}

std::vector<NodeId> nearest_nodes(std::span<const Vec3> positions, int k) { return nearest_nodes(NodeTree(positions), k); }

}  // namespace geo
