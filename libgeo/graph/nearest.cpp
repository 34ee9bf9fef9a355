#include "graph/nearest.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "graph/nearest_internal.h"

namespace geo {

void visit_nearest(const NodeTree& tree, int k, const std::function<void(NodeId, std::span<const NodeId>)>& take) {
  if (k < 0) throw InputError("nearest nodes: k is " + std::to_string(k) + ", give zero or more");
  if (tree.size() == 0) return;
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t c = 0; c < tree.cells().size(); ++c)
    if (tree.cells()[c].leaf()) leaves.push_back(c);
  // Along the Morton curve, so that each leaf can learn from the one before how far to look.
  std::sort(leaves.begin(), leaves.end(), [&](auto a, auto b) { return tree.cells()[a].begin < tree.cells()[b].begin; });
  parallel_for(leaves.size(), 64, [&](std::size_t begin, std::size_t end) {
    nearest_of_leaves(tree, std::span(leaves).subspan(begin, end - begin), static_cast<std::uint32_t>(k), take);
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
