// Cells of at most 48 nodes, in the order of the Morton curve, search as groups on all threads.
#include "graph/nearest.h"

#include <algorithm>
#include <vector>

#include "graph/nearest_lanes.h"
#include "kerf/error.h"
#include "kerf/parallel.h"

namespace geo {

void visit_nearest(const NodeTree& tree, int k, const std::function<void(NodeId, std::span<const NodeId>)>& visit) {
  if (k < 0) throw InputError("nearest nodes: k is " + std::to_string(k) + ", give zero or more");
  if (tree.size() == 0) return;
  // Nodes that search together: enough to pay for gathering candidates, few enough to share most of
  // them.
  constexpr std::uint32_t group_size = 48;  // the result does not depend on it
  const auto cells = tree.cells();
  // Along the Morton curve: each group learns its reach from the one before.
  std::vector<std::uint32_t> groups, open{0};
  while (!open.empty()) {
    const auto c = open.back();
    open.pop_back();
    if (cells[c].leaf() || cells[c].count() <= group_size)
      groups.push_back(c);
    else
      open.insert(open.end(), {cells[c].children + 1, cells[c].children});
  }
  parallel_for(groups.size(), 16, [&](std::size_t begin, std::size_t end) {
    nearest_of_groups(tree, std::span(groups).subspan(begin, end - begin), static_cast<std::uint32_t>(k), visit);
  });
}

UninitializedArray<NodeId> nearest_nodes(const NodeTree& tree, int k) {
  const auto width = static_cast<std::size_t>(std::max(k, 0));
  UninitializedArray<NodeId> rows(tree.size() * width);
  visit_nearest(tree, k, [&](NodeId i, std::span<const NodeId> row) {
    NodeId* const to = rows.data() + i.index() * width;
    std::fill(std::copy(row.begin(), row.end(), to), to + width, NodeId());
  });
  return rows;
}

UninitializedArray<NodeId> nearest_nodes(std::span<const Vec3> positions, int k) {
  return nearest_nodes(NodeTree(positions), k);
}

}  // namespace geo
